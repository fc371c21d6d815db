// What steps on a device take of a strand particle by particle, wherever its numbers lie: elements, rows of
// the system, contact. Terms, formulas and order are those of solver/chain/chain_step.h, which is the
// reference.
#pragma once

#include <utility>

#include "cuda/chain/strand_memory.h"
#include "cuda/chain/term_set.h"

namespace wetcurl {

// A particle as it is, and where its forces are taken.
template <class T>
struct Particle {
    Vec3<T> x, x_before, v, v_before, at, rate;
    T mass, rest_depth;
};

// What terms see of particles j-2, j-1, j; of edges and of what one particle has, the last.
template <class T>
struct Window {
    Vec3<T> x[3], v[3];
    T mass[3];
    Quat<T> frame[2];
    T rest_length[2], stretch_spring[2], bend_spring[2], twist_spring[2];
    Vec3<T> target[2], core[2], push[2], limit_edge[2], air[3], chord;
    T saturation[3], touching[3], phi[3], given_adhesion[3];
    Vec3<T> normal[3], surface_velocity[3];
};

// What the elements that end at particle j add to its row and the two before.
template <class T>
struct Element {
    Vec3<T> force[3];
    Sym3<T> diagonal[3];
    Mat3<T> upper1[2], upper2[1];
};

template <class T>
class StrandParts {
    using V = Vec3<T>;
    using M = Mat3<T>;

  public:
    WETCURL_HD StrandParts(const StrandMemory<T>& m, const ChainConstants<T>& constants)
        : m_(m), k_(constants) {}

    // Particle 0 or 1 of a strand at the end of a substep.
    template <class Set>
    WETCURL_HD V placed_root(const Set& set, const SubstepMotion<T>& motion, size_t strand, int i) const {
        return root_of(set, motion, strand)(m_.root[strand * 2 + size_t(i)]);
    }
    template <class Set>
    WETCURL_HD const RootMotion<T>& root_of(const Set& set, const SubstepMotion<T>& motion,
                                            size_t strand) const {
        return set.has(present::riding) ? motion.roots[strand] : motion.head;
    }

    template <class Set>
    WETCURL_HD bool sees_water(const Set& set) const {
        return (has<Adhesion>(set) || has<Stiffness>(set)) && m_.saturation;
    }
    // The rest of a window whose `x` of particle j, the k-th of all, is there.
    template <class Set>
    WETCURL_HD void fill(const Set& set, const SubstepMotion<T>& motion, size_t k, Window<T>& w) const {
        if (has<CurlPush>(set)) w.push[1] = m_.push[k - 1];
        if (has<AirDrag>(set)) w.air[1] = m_.air[k - 1], w.air[2] = m_.air[k];
        w.normal[2] = {T(0), T(1), T(0)}, w.surface_velocity[2] = {T(0), T(0), T(0)};
        if (!has<Adhesion>(set)) return;
        w.touching[2] = m_.touching[k];
        nearest(set, motion, k, w.x[2], w.phi[2], w.normal[2], w.surface_velocity[2]);
        if (is_given(set)) w.given_adhesion[2] = m_.given_adhesion[k];
    }
    template <class Set>
    WETCURL_HD Element<T> element(const Set& set, const RootMotion<T>& root, const Bdf2<T>& scheme,
                                  Window<T>& w) const {
        const V zero{T(0), T(0), T(0)};
        const Sym3<T> no_sym = identity_times(T(0));
        const M no_mat{zero, zero, zero};
        V forces[3]{zero, zero, zero}, pulls[2]{zero, zero};
        Sym3<T> diagonals[3]{no_sym, no_sym, no_sym}, edges[2]{no_sym, no_sym};
        M joints[2]{no_mat, no_mat};
        const ChainSystem<T> system{scheme.h, system.whole, forces, pulls, diagonals, edges, joints};
        ChainView<T> view{};
        view.n = 3;
        view.x = w.x, view.v = w.v, view.mass = w.mass, view.rest_length = w.rest_length;
        view.limit_edge = w.limit_edge;
        if (set.has(present::fibre))
            view.stretch_spring = w.stretch_spring, view.bend_spring = w.bend_spring,
            view.twist_spring = w.twist_spring;
        view.target = w.target, view.frame = w.frame, view.core_pull = w.core, view.push = w.push;
        view.saturation = w.saturation, view.touching = w.touching, view.phi = w.phi, view.normal = w.normal;
        view.surface_velocity = w.surface_velocity, view.air = w.air;
        if (is_given(set)) view.given_adhesion = w.given_adhesion;
        view.set_root(root);
        view.chord = w.chord;
        assemble_present(set, view, system, std::make_index_sequence<std::tuple_size_v<ChainTerms>>());
        Element<T> e;
        for (int i = 0; i < 3; ++i) {
            e.force[i] = system.whole_force(i, 3);
            system.whole_row(i, 3, e.diagonal[i], &e.upper1[i], e.upper2);
        }
        return e;
    }

    // What the k-th of all particles has of its own in its row, `force` [N] of its elements: the right side
    // is returned.
    template <class Set>
    WETCURL_HD V own_row(const Set& set, const Bdf2<T>& scheme, size_t k, const Particle<T>& p, V force,
                         Sym3<T>& diagonal) const {
        force += p.mass * k_.gravity;
        diagonal += identity_times(p.mass);
        if (set.has(present::given) && m_.given_force) {
            force += m_.given_force[k];
            if (m_.given_stiffness) {
                const T stiffness = m_.given_stiffness[k];
                force -= stiffness * (p.at - scheme.predicted(p.x, p.x_before, p.v));
                diagonal += identity_times(scheme.h * scheme.h * stiffness);
            }
        }
        return scheme.right_side(p.mass, p.v, p.v_before, p.rate, force);
    }

    // The contact of a particle that is expected at x.
    WETCURL_HD Hold<T> expected_hold(const SubstepMotion<T>& motion, const Bdf2<T>& scheme,
                                     const Particle<T>& p, const V& x, T& momentum) const {
        return expected_contact(motion, p.rest_depth, hold_stiffness(k_.rules.spring_sum, scheme.h, p.mass),
                                x, p.v, momentum);
    }
    // Of one that a solid has pushed or is to push: held while `pushed` is above 0; below it the surface may
    // hold it again.
    WETCURL_HD Hold<T> hold_of(const SubstepMotion<T>& motion, const Bdf2<T>& scheme, const Particle<T>& p,
                               T pushed) const {
        T momentum = pushed < 0 ? -pushed : pushed;
        Hold<T> hold = expected_hold(motion, scheme, p, scheme.predicted(p.x, p.x_before, p.v), momentum);
        hold.gap += scheme.h * dot(p.rate - scheme.expected_velocity(p.v), hold.normal);
        hold.weight = pushed > 0 ? hold.stiff : T(0);
        return hold;
    }
    // Whether a surface can have met a particle that a step changed by d. `gap`: from surfaces where it was
    // first expected, which tells where forces were taken no more than once.
    WETCURL_HD static bool may_meet(const Bdf2<T>& scheme, bool looked_anew, T pushed, T gap, const V& d) {
        return pushed != 0 || looked_anew || may_enter(scheme.h, gap, d);
    }
    // It is led to x and v, `pushed` as told by hold_of; these, and where it was, follow.
    WETCURL_HD void meet(const SubstepMotion<T>& motion, const Bdf2<T>& scheme, const V& d, Particle<T>& p,
                         T& pushed, V& x, V& v) const {
        pushed = pushed > 0 ? pushed_by(hold_of(motion, scheme, p, pushed), scheme.h, d) : T(0);
        for (const auto& solid : motion)
            resolve_contact(solid, T(0), solid.attached ? p.rest_depth : T(0), k_.dt, p.mass, pushed, x, p.x,
                            v, p.v);
    }
    // Whether adhesion lets go of the k-th of all particles, expected at x.
    template <class Set>
    WETCURL_HD void touch(const Set& set, const SubstepMotion<T>& motion, size_t k, const V& x) const {
        T phi;
        V normal, surface_velocity;
        nearest(set, motion, k, x, phi, normal, surface_velocity);
        T& touching = m_.touching[k];
        touching = updated_touching(touching, phi, T(get<Adhesion>(k_.rules.terms).h_a));
    }

  private:
    template <class Set>
    WETCURL_HD bool is_given(const Set& set) const {
        return set.has(present::given) && m_.given_adhesion;
    }
    // The surface that adhesion sees from x.
    template <class Set>
    WETCURL_HD void nearest(const Set& set, const SubstepMotion<T>& motion, size_t k, const V& x, T& phi,
                            V& normal, V& velocity) const {
        if (is_given(set))
            phi = m_.given_phi[k], normal = m_.given_normal[k], velocity = m_.given_surface_velocity[k];
        else
            sample_nearest(motion, x, phi, normal, velocity);
    }
    template <class Set, size_t... place>
    WETCURL_HD void assemble_present(const Set& set, const ChainView<T>& view, const ChainSystem<T>& system,
                                     std::index_sequence<place...>) const {
        ((set.has(int(place)) ? std::get<place>(k_.rules.terms)->assemble(view, system, 2, 3) : void()), ...);
    }

    const StrandMemory<T>& m_;
    const ChainConstants<T>& k_;
};

}  // namespace wetcurl
