// A scene: what a TOML file names, as values. A table that is not written is not there.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/config.h"
#include "base/geometry/shapes.h"
#include "base/gravity.h"
#include "base/shift_units.h"
#include "base/strands.h"
#include "solver/compared/list.h"
#include "solver/grooms/strand_findings.h"
#include "solver/motion/deformation.h"
#include "solver/motion/motion.h"
#include "solver/motion/riding.h"
#include "solver/terms/air.h"
#include "solver/terms/cohesion.h"
#include "solver/terms/curl.h"
#include "solver/terms/fibre.h"
#include "solver/terms/flow.h"
#include "solver/terms/list.h"
#include "solver/terms/strand_contact.h"
#include "solver/terms/wetness.h"

namespace wetcurl {

struct Integrator : Gravity {
    static constexpr const char* kinds[] = {"implicit", "backward_euler", "explicit"};
    std::string kind = "implicit";
    int substeps = 10;           // a frame
    int max_linearisations = 4;  // in a substep (key `looks`)
    double relinearise_angle =
        0.002;          // [rad] rotation of an edge above which a substep is linearised again (key `turn`)
    double settle = 0;  // [s] simulated before frame 0 with everything held at its first pose
    // Times its rest length: a longer edge ends the run. It does not act on the strands.
    double allow_stretch = 10;
    double settle_after_cut = 0.5;  // [s] the same at each cut
    bool is_implicit() const { return kind != "explicit"; }
    static constexpr Parameter<Integrator> parameters[] = {
        {KeyRow::one_of(
             "kind", kinds, "implicit",
             "BDF2, backward Euler, or the paper's symplectic Euler; with [baseline] chain = \"iben\" "
             "the default is explicit."),
         &Integrator::kind},
        {KeyRow::integer("substeps", 10, 1, 1'000'000, "Substeps of a frame."), &Integrator::substeps},
        {KeyRow::integer("looks", 4, 1, 1000, "Largest number of linearisations of a substep."),
         &Integrator::max_linearisations},
        {KeyRow::number("turn", "rad", 0.002, 0, 10,
                        "Rotation of an edge above which a substep is linearised again."),
         &Integrator::relinearise_angle},
        {KeyRow::number("settle", "s", 0, 0, 1000,
                        "Time simulated before frame 0, with head and solids held at their first pose."),
         &Integrator::settle},
        {KeyRow::number("allow_stretch", "1", 10, 1, 1e9,
                        "Largest length of an edge over its rest length; a longer one ends the run as "
                        "diverged."),
         &Integrator::allow_stretch},
        {KeyRow::number(
             "settle_after_cut", "s", 0.5, 0, 1000,
             "Time simulated at each cut of [motion], with head and solids held at their pose then."),
         &Integrator::settle_after_cut},
    };
};

struct Solid {
    std::string name;
    Shape shape;                               // of a rigid one
    std::shared_ptr<Deformation> deformation;  // in its place; null: rigid
    bool driven = false;                       // a caller brought it and moves its vertices
    double spacing = 0;                        // [m] of a mesh's level set; 0: the usual one
    Bounds region{{0, 0, 0}, {0, 0, 0}};  // [m] of a mesh that deforms: where it is at any time of the run
    std::vector<Finding> findings;        // of its mesh
    Motion motion;
    ShotCuts cuts;               // its own, beside those of the shot
    bool attached = false;       // to the head
    bool carries_roots = false;  // deforms, and roots ride on it
    double friction = 0.3;       // Coulomb
    Pose at(double time, const Pose& head) const { return attached ? head : motion.at(time); }
    // Then hair may lie as deep in it as it is drawn.
    bool moves_with_roots() const { return attached || carries_roots; }
};

// The network that `infer` runs in place of the physics; the solver knows its name alone.
struct Learned {
    std::string model;        // file; trained or not yet
    std::string reconstruct;  // paper | core; "": the model's own
    // Of Eq 18, for models of the root codec.
    std::optional<double> gain;  // kappa; none: the model's own
    std::string units;           // length | printed; "": the model's own
    static constexpr const char* reconstructions[] = {"paper", "core"};
    static constexpr const char* own = "the model's own";
    static constexpr Parameter<Learned> parameters[] = {
        {KeyRow::path("model", "needed", "File of the network, trained or yet to be trained."),
         &Learned::model},
        {KeyRow::one_of("reconstruct", reconstructions, "", "How the root codec reconstructs strands.",
                        "Eq 18; core is ours")
             .without_default(own),
         &Learned::reconstruct},
        {gain_row.without_default(own), &Learned::gain},
        {shift_units_row.without_default(own), &Learned::units},
    };
};

// Roots that do not move with the head: on a solid that deforms, or each as a caller drives it.
struct Riding {
    Motion motion;                     // of that solid
    std::optional<RidingRoots> roots;  // on it
    std::vector<DrivenMotion> driven;  // (strand) from rest; in their place
    Bounds reach;  // [m] that the hair can reach at any time of the run, in the frame of the head

    // (strand), from rest to `time`.
    void poses_at(double time, RidingRoots::Room& room) const;
    // The rigid motion nearest to that of all roots; `rest` (strand, particle) [m].
    Pose middle_at(double time, const Strands& rest, RidingRoots::Room& room) const;
};

struct Scene {
    std::string title;
    int frames = 100;
    double fps = 24;
    unsigned long long seed = 1;
    double linear_density = 6.5e-6;  // [kg/m] of dry hair: 1300 kg/m^3, 80 um across
    double volume_density = 1300;    // rho [kg/m^3]
    std::string rest = "drawn";      // drawn | sag_free
    Integrator integrator;
    ChainTerms chain;
    Slot<Fibre> fibre;  // its springs are those of `chain`
    Slot<Wetness> wetness;
    Slot<Flow> flow;  // of the water
    Slot<Curl> curl;
    Slot<Cohesion> cohesion;
    Slot<StrandContact> strand_contact;
    Slot<Air> air;
    std::string adhesion_model;  // file of a network in Eq 11's place; "": Eq 11
    Baselines baselines;         // compared methods in place of ours, part by part
    std::optional<Learned> learned;
    Motion motion;  // of the head
    std::vector<Solid> solids;
    std::optional<Riding> riding;  // of the groom's roots; none: all move with the head
    ShotCuts cuts;                 // of the shot, at which all that is in it may stand elsewhere
    double preroll = 0;            // [s] before frame 0, from rest to the first pose
    double end = 0;                // [s] until which what moves is surveyed: no run goes farther
    bool endless = false;          // but as long as a caller asks, who also moves and wets things

    std::vector<std::string> allow;       // findings (solver/scene/findings.h) that do not stop the scene
    std::vector<Finding> groom_findings;  // of the strands' file
    CurlTurns curl_turns;                 // of the full groom as drawn

    Groom groom;     // of this run: the full groom, thinned by `stride`, or `guides` of it
    int stride = 1;  // every how many roots each way of the full grid
    int guides = 0;  // above 0: so many strands, chosen (solver/grooms/guides.h), in place of a grid
    std::vector<float> saturation;   // (strand, particle) at the start; empty without wetness
    std::vector<double> thickness;   // (strand) of a fibre's diameter; empty: all 1
    std::string text, folder;        // the resolved TOML, and where its relative paths start
    std::vector<std::string> files;  // what it was read from: scene, includes, hair, meshes, networks

    static constexpr const char* rests[] = {"drawn", "sag_free"};
    static constexpr Parameter<Scene> parameters[] = {
        {KeyRow::text("title", "", "Name of the scene in messages, reports and pictures."), &Scene::title},
        {KeyRow::integer("frames", 100, 1, 1'000'000, "Frames to simulate."), &Scene::frames},
        {KeyRow::number("fps", "1/s", 24, 1, 10000, "Frames of a second."), &Scene::fps},
        {KeyRow::integer("seed", 1, 0, double(largest_seed), "Seed of all that is random."), &Scene::seed},
        {KeyRow::some_of("allow", Finding::names,
                         "Findings, as `inspect scene` names them, that do not stop the scene."),
         &Scene::allow},
    };
    static constexpr Parameter<Scene> groom_parameters[] = {
        {KeyRow::number("linear_density", "kg/m", 6.5e-6, 1e-12, 1e3,
                        "Mass of a metre of dry hair; the default is hair 80 um across."),
         &Scene::linear_density},
        {KeyRow::number("density", "kg/m^3", 1300, 1, 1e5, "Density of hair.", "rho"),
         &Scene::volume_density},
        {KeyRow::one_of(
             "rest", rests, "drawn",
             "The shape at rest is the groom as drawn, or the one that hangs as drawn under gravity "
             "(sag_free); that one needs [bend]."),
         &Scene::rest},
    };
    static constexpr Parameter<Scene> adhesion_parameters[] = {
        {KeyRow::path("model", "Eq 11", "File of a network in place of Eq 11."), &Scene::adhesion_model},
    };

    template <class Term>
    Slot<Term>& term() {
        return std::get<Slot<Term>>(chain);
    }
    template <class Term>
    const Slot<Term>& term() const {
        return std::get<Slot<Term>>(chain);
    }
    template <class Method>
    const Slot<Method>& baseline() const {
        return std::get<Slot<Method>>(baselines);
    }
    bool names_baseline() const {
        bool any = false;
        for_each_present(baselines, [&](const auto&) { any = true; });
        return any;
    }
    double thickness_of(int strand) const { return thickness.empty() ? 1 : thickness[size_t(strand)]; }
    // [m] diameter of a dry strand at a share of its length from the root.
    double hair_width(int strand, double along) const;
    bool has_deforming_solid() const {
        for (const auto& s : solids)
            if (s.deformation) return true;
        return false;
    }
    bool has_solid_with_roots() const {
        for (const auto& s : solids)
            if (s.moves_with_roots()) return true;
        return false;
    }
    // The pose of the head [m]; where roots ride on a solid, the rigid motion nearest to theirs. In the
    // preroll, before time 0, on its way from rest.
    Pose head_at(double time, RidingRoots::Room& room) const;
    Pose head_at(double time) const {
        RidingRoots::Room room;
        return head_at(time, room);
    }
    // Poses of roots that ride, (strand), each in the place of the head's.
    void root_poses_at(double time, RidingRoots::Room& room) const;
    // The frame in which the level set of a solid that deforms stands, with the head at `head`: where roots
    // ride that of the head, so that little moves in it. And the vertices of the mesh there.
    Pose surface_frame(const Solid& solid, double time, const Pose& head) const {
        return riding ? head : solid.at(time, head);
    }
    void surface_vertices(const Solid& solid, double time, std::vector<Vec3f>& out) const;
    // [s] where its run begins: 0, or before it for the preroll, which takes whole frames.
    double begin() const { return -std::ceil(preroll * fps) / fps; }
    // Share of the preroll that is over, 1 from time 0 on; rises smoothly.
    double share_of_preroll(double time) const;
};

// (strand) [m]
std::vector<Vec3d> roots_of(const Strands& hair);
// [m] from its root, beyond which no point of a strand goes: none is stretched by a quarter.
double reach_of_strand(const Strands& hair, int s);
// What hair [m] can reach of the frame in which its roots rest.
Bounds reach_of_roots(const Strands& hair);

// Makes the roots of the scene's groom, those in `kept` of `full`, ride on a solid that deforms. One that is
// attached moves by the head's own motion; what else is attached to the head follows the roots.
void ride(Scene& scene, Solid& solid, const Groom& full, const std::vector<int>& kept);
// A caller drives each root; until then they rest where the head is at time 0.
void drive_roots(Scene& scene);
// The solid on which the roots of `full` ride though `[groom] scalp` names none: the one attached to the head
// that deforms, where they lie on it. Warns that it is a guess. Null: none.
Solid* guessed_scalp(Scene& scene, const Groom& full);
// Finds Solid::region of what deforms, and Riding::reach; and cuts where the scene does not say them, with a
// warning. Then all that moves comes to rest at its cuts.
void survey(Scene& scene, const Groom& full);

// What a caller brings along in memory.
struct Brought {
    StrandPoints strands;                // [m], in the frame of the head, root first; empty: the scene's own
    std::map<std::string, Mesh> meshes;  // of [[solid]]s by name [m], which the caller drives
};

struct SceneOptions {
    std::vector<std::string> set;        // key.path=value
    std::optional<int> frames, strands;  // --frames, --strands
    int guides = 0;                      // so many strands, chosen, where above 0
    std::optional<long> seed;
    std::string groom;  // a hair file in place of the scene's groom
    int stride = 0;     // exactly this stride of the full grid, where above 0
    const Brought* brought = nullptr;
    double start = 0;           // [s] of its run's frame 0: it goes on with another run
    bool endless = false;       // its run goes on as long as a caller asks, not for `frames`
    bool findings_stop = true;  // load_scene acts on what looks wrong (solver/scene/findings.h)
};

// Reads and checks a scene; builds its groom, wetness and level sets. Throws Misuse (a wrong key or value,
// with file and line) or Error (bad data).
Scene load_scene(const std::string& path, const SceneOptions& options = {});
Scene parse_scene(const std::string& text, const std::string& name, const std::string& folder,
                  const SceneOptions& options = {});
Scene parse_scene(const Config& config, const SceneOptions& options = {});

// The scene as a dry one: no wet weight, curl, cohesion, adhesion, nor a compared method of them; its
// saturation is kept as a record.
void make_dry(Scene& scene);
// The scene before cohesion: without Eq 10, which moves what is displayed alone. Strands move the same. A
// scene whose cohesion acts in the solve too stays as it is.
void leave_out_display(Scene& scene);

// Whether anything of the scene acts on wet hair.
bool acts_wet(const Scene& scene);

// Of a run of it: "simulated dry", "simulated wet", and the compared methods that it names.
std::string method_of(const Scene& scene);

}  // namespace wetcurl
