// The strands of a scene in a device's memory, and what kernels are told beside it.
#pragma once

#include "solver/passes/substep.h"

namespace wetcurl {

// (strand, particle) in the device's memory. Null where no present term needs it.
template <class T>
struct StrandMemory {
    int n, strands;
    Vec3<T>*x, *x_before, *v, *v_before;
    T *touching, *pushed;
    Quat<T>* frame;
    const Vec3<T>*root, *target, *push, *air;  // root: (strand, 2) in the head's frame
    const T *mass, *rest_length, *rest_core, *saturation, *rest_depth;
    // What others give for the substeps that follow, as of GivenToChain, and the surfaces nearest to where
    // adhesion was asked for.
    const Vec3<T>* given_force;
    const T *given_stiffness, *given_adhesion, *given_phi;
    const Vec3<T>*given_normal, *given_surface_velocity;
};

// What is the same for all strands and substeps.
template <class T>
struct ChainConstants {
    SubstepRules<T> rules;
    T dt, share, turn;
    int looks;  // as of a BlockStep
    Vec3<T> gravity;
};

template <class T>
using DeviceSolid = PosedSolid<T, ShapeView>;

// One substep's motion of the head and of `count` solids.
template <class T>
struct SubstepMotion {
    Quat<T> head_rotation, root_turn;
    Vec3<T> head_translation, turn, turn_center, drift;
    const DeviceSolid<T>* solids;
    int count;
    WETCURL_HD const DeviceSolid<T>* begin() const { return solids; }
    WETCURL_HD const DeviceSolid<T>* end() const { return solids + count; }
};

}  // namespace wetcurl
