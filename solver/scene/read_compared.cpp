// Reading [baseline].
#include "solver/scene/read_compared.h"

namespace wetcurl {

namespace {

// `method` is the shorthand of one part alone.
bool is_shorthand(const Table& baseline) { return baseline.has("method"); }

// The row that names the method of a part, or of any part under `method`.
const KeyRow& naming_row(const char* key) {
    static const std::vector<KeyRow> rows = [] {
        static std::vector<std::vector<const char*>> words;
        static const auto parts = baseline_parts();
        words.reserve(parts.size() + 1);
        std::vector<KeyRow> out;
        auto add = [&](const char* name, std::vector<const char*> names, const char* meaning) {
            words.push_back(std::move(names));
            out.push_back(KeyRow::one_of(name, words.back(), "", meaning).without_default("ours"));
        };
        for (const auto& part : parts)
            add(part.c_str(), baselines_of(part), "Compared method in place of this part of ours.");
        add("method", baseline_names(), "One compared method alone: a shorthand of the key of its part.");
        return out;
    }();
    return *std::find_if(rows.begin(), rows.end(),
                         [&](const KeyRow& row) { return row.key == std::string(key); });
}

// As the scene says it: method = "lin", or cohesion = "lin".
template <class Method>
std::string spelled(const Table& baseline) {
    if (is_shorthand(baseline)) return std::string("method = \"") + Method::name + "\"";
    return std::string(Method::part) + " = \"" + within_part(Method::part, Method::name) + "\"";
}

template <class Method>
bool names(const Table& t) {
    if (is_shorthand(t)) return t.text(naming_row("method")) == Method::name;
    return t.text(naming_row(Method::part)) == within_part(Method::part, Method::name);
}

void require_methods(const Table& t) {
    const auto parts = baseline_parts();
    bool any = is_shorthand(t);
    std::string forms;  // chain = "iben", …
    for (const auto& part : parts) {
        if (is_shorthand(t) && t.has(part))
            t.fail("method", "found beside `" + part +
                                 "`, allowed is one of the two: `method` is the shorthand "
                                 "of a single part");
        any = any || t.has(part);
        const auto names = baselines_of(part);
        forms += (forms.empty() ? "" : ", ") + part + " = ";
        for (const char* name : names)
            forms += (name == names.front() ? "\"" : " | \"") + std::string(name) + "\"";
    }
    if (!any) t.fail("", "found no compared method, needed is at least one of " + forms + ", or `method`");
}

// A method's row as the table spells it: under `method`, which names one alone, it may go without its part.
const char* key_of(const Table& t, const char* part, const char* row) {
    const char* alone = within_part(part, row);
    return is_shorthand(t) && t.has(alone) && !t.has(row) ? alone : row;
}

// Rows that are not `taken` are unknown keys.
void refuse_other_rows(const Table& t, const std::vector<std::string>& taken) {
    std::string allowed;
    for (const auto& key : taken) allowed += (allowed.empty() ? "" : ", ") + key;
    auto refuse = [&]<class Method>(const Method&, const char* row, const std::string& key) {
        if (!t.has(key) || std::find(taken.begin(), taken.end(), key) != taken.end()) return;
        const std::string reason = names<Method>(t) ? spelled<Method>(t) + " calls it " + row
                                                    : "it belongs to '" + std::string(Method::name) +
                                                          "', which this [baseline] does not name";
        t.fail(key, "unknown key: " + reason + "; allowed: " + allowed);
    };
    for_each_baseline([&](const auto& method) {
        for (const auto& row : method.parameters)
            refuse(method, row.key, row.key), refuse(method, row.key, within_part(method.part, row.key));
    });
}

void check_iben(Scene& scene, const Table& root, const std::string& as) {
    if (root.has("stiffness"))  // Eq 13 is what the paper adds to it
        root.fail("stiffness", as + " runs without [stiffness]; leave one of them out");
    if (scene.integrator.is_implicit()) root.table("integrator").fail("kind", as + " steps explicitly");
    auto print = [&](auto& slot) {
        if (!slot) return;
        const Table t = root.table(slot->table);
        if (!slot->printed && t.has("form")) t.fail("form", as + " has the printed form");
        slot->printed = true;
    };
    print(scene.term<Bend>()), print(scene.term<Core>());
    scene.term<Twist>().reset();
}

// Forces on wet hair in the place of our table `ours`.
void check_wet_forces(const Scene& scene, const Table& root, const std::string& as, const char* ours) {
    if (scene.flow)
        root.table(Wetness::table).fail("flow", as + " reads the saturation once; leave [wetness.flow] out");
    if (!scene.wetness) root.fail("baseline", as + " acts on wet hair and needs a [wetness] table");
    if (root.has(ours)) root.fail(ours, as + " runs without [" + ours + "]; leave one of them out");
}

void check_boundary(const Scene& scene, const Table& root, const std::string& as) {
    check_wet_forces(scene, root, as, Adhesion::table);
    if (scene.solids.empty()) root.fail("baseline", as + " needs a [[solid]] to lie on");
    if (scene.has_deforming_solid())
        root.fail("baseline", as + " lies on rigid solids; leave [[solid.mesh]] out");
}

}  // namespace

std::vector<KeyRow> baseline_rows() {
    std::vector<KeyRow> rows;
    for (const auto& part : baseline_parts()) rows.push_back(naming_row(part.c_str()));
    rows.push_back(naming_row("method"));
    for_each_baseline([&](const auto& method) {
        for (KeyRow row : method.parameters) {
            rows.push_back(row);
            const char* alone = within_part(method.part, row.key);
            if (alone == row.key) continue;
            row.key = alone, row.when = {"method", method.name};
            rows.push_back(row);
        }
    });
    return rows;
}

void read_baselines(Scene& scene, const Table& root) {
    if (!root.has("baseline")) return;
    const Table t = root.table("baseline");
    require_methods(t);
    std::vector<std::string> taken;
    auto read = [&](auto& slot) {
        using Method = typename std::decay_t<decltype(slot)>::value_type;
        if (!names<Method>(t)) return;
        slot.emplace();
        for (auto row : Method::parameters) {
            row.key = key_of(t, Method::part, row.key);
            taken.push_back(row.key);
            read_parameter(*slot, row, t);
        }
    };
    std::apply([&](auto&... slot) { (read(slot), ...); }, scene.baselines);
    refuse_other_rows(t, taken);
}

void check_baselines(Scene& scene, const Table& root) {
    const Table t = root.table("baseline");
    for_each_present(scene.baselines, [&]<class Method>(const Method&) {
        const std::string as = "[baseline] " + spelled<Method>(t);
        if constexpr (std::is_same_v<Method, Iben2013>)
            check_iben(scene, root, as);
        else if constexpr (std::is_same_v<Method, BoundaryParticles2013>)
            check_boundary(scene, root, as);
        else
            check_wet_forces(scene, root, as, Cohesion::table);
    });
}

}  // namespace wetcurl
