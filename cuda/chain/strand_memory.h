// The strands of a scene in a device's memory, and what kernels are told beside it.
#pragma once

#include "solver/chain/substep.h"

namespace wetcurl {

// (strand, particle) in the device's memory. Null where no present term needs it.
template <class T>
struct StrandMemory : StrandArrays<T, Pointer> {
    int n, strands;
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
    T dt, share, relinearise_angle;  // as of a BlockStep
    int max_linearisations;
    Vec3<T> gravity;
};

template <class T>
using DeviceSolid = PosedSolid<T, ShapeView>;

// One substep's motion of the head, of roots and of `count` solids.
template <class T>
struct SubstepMotion {
    RootMotion<T> head;
    const RootMotion<T>* roots;  // (strand) of a scene whose roots ride on a solid; else not read
    const DeviceSolid<T>* solids;
    int count;
    WETCURL_HD const DeviceSolid<T>* begin() const { return solids; }
    WETCURL_HD const DeviceSolid<T>* end() const { return solids + count; }
};

}  // namespace wetcurl
