// Ways of stepping, and which cases each goes through.
#include "solver/stability/battery.h"

#include <algorithm>
#include <cmath>

#include "solver/stability/cases.h"

namespace wetcurl {

namespace {

// Half decades upwards.
std::vector<Figures> decades_of(const Figures& from, int count) {
    std::vector<Figures> all;
    for (int k = 0; k < count; ++k) {
        all.push_back(from);
        for (auto& [key, value] : all.back()) value *= (k % 2 ? 3 : 1) * std::pow(10.0, k / 2);
    }
    return all;
}
// Ours on fibres in the place of springs.
StabilityMethod of_fibres(double diameter, const std::string& precision) {
    StabilityMethod m{
        .name = "ours", .integrator = "fibre " + precision, .precision = precision, .settings = {}};
    m.fibre = diameter;
    return m;
}
// The same, that touch each other and, wet, cohere in every substep.
StabilityMethod of_fibres_that_touch(double diameter, const std::string& precision) {
    StabilityMethod m = of_fibres(diameter, precision);
    m.name = "ours touching", m.dry = false;
    m.cohesion = "[cohesion]\nradius = 0.012\nstrength = 5000\n[strand_contact]\n";
    return m;
}
// Its forces on wet hair in the place of ours, on our chain.
StabilityMethod compared(const std::string& name, std::vector<Figures> sweep) {
    StabilityMethod m{.name = name, .integrator = "implicit double", .precision = "double", .settings = {}};
    m.dry = false;
    m.on_solids = name == "boundary_particles", m.on_strands = !m.on_solids;
    (m.on_solids ? m.adhesion : m.cohesion) = "[baseline]\nmethod = \"" + name + "\"\n";
    m.sweep = std::move(sweep);
    return m;
}
// The same on Iben's chain, as the paper runs them. What that chain does by itself, "iben" shows.
StabilityMethod on_iben(const std::string& cohesion, std::vector<Figures> sweep) {
    StabilityMethod m = compared(cohesion, std::move(sweep));
    m.name += " on iben", m.integrator = "explicit double";
    m.cohesion = "[baseline]\nchain = \"iben\"\ncohesion = \"" + cohesion + "\"\n";
    m.order = 1, m.takes_drag = false;
    return m;
}

}  // namespace

const std::vector<StabilityMethod>& stability_methods() {
    static const std::vector<std::string> printed{"integrator.kind='explicit'", "bend.form='printed'",
                                                  "core.form='printed'"};
    static const std::vector<StabilityMethod> methods{
        {"ours", "implicit double", "double", {}, 2, {}, {}},
        {"ours", "implicit float", "float", {}, 2, {}, {}},
        of_fibres(70e-6, "double"),
        of_fibres(40e-6, "float"),
        of_fibres(70e-6, "float"),
        of_fibres(120e-6, "float"),
        of_fibres_that_touch(70e-6, "double"),
        of_fibres_that_touch(70e-6, "float"),
        {"printed", "explicit double", "double", printed, 1, {}, {}},
        {.name = "iben",
         .integrator = "explicit double",
         .precision = "double",
         .settings = {"baseline.method='iben'"},
         .order = 1,
         .on_strands = false,
         .on_solids = false,
         .takes_drag = false,
         .sweep = decades_of({{"velocity_limit", 0.03}}, 7)},
        compared("lin", decades_of({{"strength", 10}}, 9)),
        compared("kim", decades_of({{"strength", 1}, {"area", 1e-3}}, 9)),
        compared("boundary_particles", decades_of({{"strength", 1}}, 9)),
        on_iben("lin", decades_of({{"strength", 100}}, 5)),
        on_iben("kim", decades_of({{"strength", 10}, {"area", 1e-2}}, 5)),
    };
    return methods;
}

std::vector<StabilityJob> stability_jobs(const StabilityMethod& method, const StabilityOptions& options) {
    using namespace stability;
    const Battery b{method, options};
    std::vector<StabilityJob> jobs;
    auto add = [&](const char* id, std::function<Cases()> run) {
        const auto& only = options.only;
        if (only.empty() || std::find(only.begin(), only.end(), id) != only.end()) jobs.push_back({id, run});
    };
    const bool wet = method.on_strands || method.on_solids, fibre = method.fibre > 0;
    // Of springs; fibres have their own.
    const auto some = [&](const std::vector<double>& all, const std::vector<double>& few) {
        return fibre ? std::vector<double>{0} : b.some(all, few);
    };
    if (method.dry) {
        for (double dt : b.some({dt_usual, dt_usual / 10}, {dt_usual}))
            for (double k : some({1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10}, {1e3, 1e5, 1e8}))
                add("S1", [=] { return Cases{noise_at_rest(b, k, dt)}; });
        for (double k : some({1e3, 1e4, 1e5, 1e6, 1e8, 1e10}, {1e4, 1e7}))
            add("S2", [=] { return energies_of(b, k); });
        for (double k : some({1e3, 1e6, 1e10}, {1e5})) add("S3", [=] { return jacobians(b, k); });
        for (double k : some({1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e10, 1e12, 1e14}, {1e4, 1e8, 1e14}))
            add("S4", [=] { return stiffness_by_step(b, k); });
        for (double k : some({1e4, 1e7, 1e10}, {1e6}))
            for (double limiter : {0.0, 0.1}) add("S5", [=] { return ordeals(b, k, limiter); });
        for (double k : some({1e4, 1e5, 1e6}, {1e5})) add("S6", [=] { return Cases{order_in_time(b, k)}; });
        if (method.takes_drag && !fibre) add("S6", [=] { return Cases{order_in_particles(b)}; });
        for (double k : some({1e4, 1e6}, {1e5}))
            add("S7", [=] { return invariances(b, {.shapes = {straight, curly}, .k_over_m = k}, ""); });
        for (double k : some({1e4, 1e6, 1e8}, {1e4})) add("S8", [=] { return Cases{limiter_honesty(b, k)}; });
    }
    if (fibre && method.dry) {
        add("S10", [=] { return fibres(b, method.fibre); });
        if (method.fibre == 70e-6 && method.precision == "double")
            for (const char* hair : {"type1", "type2b", "type3a", "type3b", "type3c", "type4a"})
                if (!options.quick || hair == std::string("type3b"))
                    add("S6", [=] { return orders_of_fibres(b, hair); });
    }
    for (double k : some({1e4, 1e6, 1e8}, {1e6})) {
        if (method.on_strands) add("S1", [=] { return Cases{noise_beside_neighbours(b, k)}; });
        if (wet) {
            add("S2", [=] { return energies_of_wet(b, k); });
            add("S5", [=] { return wet_ordeals(b, k); });
        }
    }
    if (method.on_strands) add("S7", [=] { return invariances(b, wet_lock(b, 1e5), ", wet lock"); });
    // A scene that is given names wet terms of its own: those of `ours`.
    const bool wet_as_ours = !method.compared() && method.cohesion == StabilityMethod().cohesion;
    if (wet && (options.scene.empty() || wet_as_ours))
        for (double factor : b.some({0.01, 0.1, 1, 10, 100, 1e4}, {1, 100}))
            add("S9", [=] { return everything_at_once(b, factor); });
    if (fibre && method.fibre == 70e-6 && options.scene.empty())
        for (const HairKind& kind : hair_kinds)
            if (!options.quick || (method.dry && kind.name == std::string("type4a")))
                add("S9", [=] { return Cases{everything_on(b, kind.name)}; });
    return jobs;
}

}  // namespace wetcurl
