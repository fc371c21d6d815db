// The rows of a scene, gathered from the tables that they fill.
#include "solver/scene/scene_rows.h"

#include "solver/grooms/procedural.h"
#include "solver/scene/read_compared.h"
#include "solver/scene/read_solids.h"
#include "solver/scene/scene.h"

namespace wetcurl {

namespace {

class Listing {
  public:
    std::vector<TableRow> tables;

    void open(const TableRow& table) { tables.push_back(table); }
    // Rows of the table that was opened last.
    template <class Owner, size_t N>
    void add(const Parameter<Owner> (&rows)[N]) {
        tables.back().rows.insert(tables.back().rows.end(), std::begin(rows), std::end(rows));
    }
    // A table and its rows, with those of the other chain terms that lie in it.
    template <class Term>
    void add_term(bool repeats = false, When when = {}) {
        open({.name = Term::table, .meaning = Term::about, .repeats = repeats, .when = when});
        add(Term::parameters);
        add_guests();
    }
    // Those of chain terms that have no table of their own.
    void add_guests() {
        std::apply([&](const auto&... slot) { (add_guest<std::decay_t<decltype(*slot)>>(), ...); },
                   ChainTerms{});
    }
    void add_chain_terms() {
        std::apply([&](const auto&... slot) { (add_host<std::decay_t<decltype(*slot)>>(), ...); },
                   ChainTerms{});
    }
    void add_motion(const std::string& name, const std::string& what, bool always, bool in_shot,
                    When when = {}) {
        open({.name = name, .meaning = "Motion of " + what + ".", .always = always, .when = when});
        add(MotionTable::parameters);
        if (in_shot) add(CutsTable::parameters);
        if (name == "motion") add(Preroll::parameters);
        open({.name = name + ".keyframe",
              .meaning = "A pose of " + what + " at a time; between them the motion is smooth.",
              .repeats = true});
        add(KeyframeTable::parameters);
    }

  private:
    template <class Term>
    void add_guest() {
        if constexpr (!requires { Term::about; })
            if (tables.back().name == Term::table) add(Term::parameters);
    }
    template <class Term>
    void add_host() {
        if constexpr (requires { Term::about; }) add_term<Term>();
    }
};

std::vector<TableRow> listed() {
    Listing list;
    list.open({.name = "", .meaning = "Keys above the first table.", .always = true});
    list.tables.back().rows.push_back(include_row);
    list.add(Scene::parameters);

    list.open({.name = "groom",
               .meaning = "The strands: the built-in groom, or those of a file; and the substance of hair.",
               .always = true});
    list.add(GroomTable::parameters);
    list.add(procedural_parameters);
    list.add(Scene::groom_parameters);

    list.open({.name = Gravity::table, .meaning = "How time is stepped.", .always = true});
    list.add(Integrator::parameters);
    list.add(Gravity::parameters);
    list.add_guests();

    list.add_term<Fibre>();
    list.add_motion("motion", "the head", true, true);
    list.add_chain_terms();
    for (auto& table : list.tables)
        if (table.name == Adhesion::table)
            table.rows.insert(table.rows.end(), std::begin(Scene::adhesion_parameters),
                              std::end(Scene::adhesion_parameters));

    list.add_term<Wetness>();
    list.add_term<Flow>();
    list.add_term<WaterSource>(true, {"flow"});
    list.add_motion("wetness.source.motion", "a body of water", true, false);
    list.add_term<Curl>();
    list.add_term<Cohesion>();
    list.add_term<StrandContact>();

    list.open({.name = "solid",
               .meaning = "A solid that hair touches; the head itself is one, with attached = \"head\".",
               .repeats = true});
    list.add(SolidTable::parameters);
    list.add_motion("solid.motion", "a solid", true, true, {"attached", "none", true});
    list.open({.name = "solid.mesh",
               .meaning = "A keyframe of a mesh that deforms; two or more.",
               .repeats = true,
               .when = {"shape", "mesh"}});
    list.add(MeshKeyframeTable::parameters);

    list.add_term<Air>();
    list.add_term<AirSource>(true);

    list.open({.name = "baseline", .meaning = "Published methods in place of parts of ours."});
    for (const KeyRow& row : baseline_rows()) list.tables.back().rows.push_back(row);

    list.open({.name = "learned", .meaning = "The network that `wetcurl infer SCENE.toml` runs."});
    list.add(Learned::parameters);
    return list.tables;
}

}  // namespace

const std::vector<TableRow>& scene_rows() {
    static const std::vector<TableRow> rows = listed();
    return rows;
}

}  // namespace wetcurl
