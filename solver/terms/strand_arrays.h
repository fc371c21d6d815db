// The arrays of the strands, the one list: members on the CPU and on a device, views of a block, copies, save
// and restore, memory and its labels follow from it. A new array is a line here.
#pragma once

#include <vector>

#include "base/buffer_list.h"
#include "base/vec3.h"

namespace wetcurl {

// How many entries of an array belong to a strand of n particles: one for each particle or edge, n of them,
// the last edge's unused; or one for particles 0 and 1.
enum class ArrayExtent { particles, roots };

// When an array changes, and so when it is copied between host and device.
enum class StrandPart {
    motion,   // in each substep: what is read of the strands from outside
    history,  // in each substep: what else the next one needs
    water,    // with the water in the hair
    fixed,    // never, or by the air alone
};

struct StrandArrayInfo {
    const char* label;
    ArrayExtent extent;
    StrandPart part;
    BufferUse use;
    size_t entries(int n) const { return extent == ArrayExtent::roots ? 2 : size_t(n); }
};

// ROW(name, type of a value, extent, part, use, label, when a scene needs it, given `scene`). All that a
// simulation goes on from:
#define WETCURL_STATE_ARRAYS(ROW)                                                                        \
    /* [m], [m/s] now and one substep ago */                                                             \
    ROW(x, Vec3<S>, particles, motion, read, "positions", true)                                          \
    ROW(x_before, Vec3<S>, particles, history, written, "positions before", true)                        \
    ROW(v, Vec3<S>, particles, motion, read, "velocities", true)                                         \
    ROW(v_before, Vec3<S>, particles, history, written, "velocities before", true)                       \
    /* F_i of edges */                                                                                   \
    ROW(frame, Quat<S>, particles, motion, written, "bend frames", scene.term<Bend>().has_value())       \
    /* 1 where a particle has been in contact and not let go, else 0 */                                  \
    ROW(touching, S, particles, motion, written, "adhesion contact", scene.term<Adhesion>().has_value()) \
    /* [kg m/s] that solids gave in the last substep */                                                  \
    ROW(pushed, S, particles, history, written, "contact momentum", !scene.solids.empty())

// And beside them:
#define WETCURL_STRAND_ARRAYS(ROW)                                                                         \
    WETCURL_STATE_ARRAYS(ROW)                                                                              \
    /* [m] particles 0 and 1 in the frame of the root, the head's at rest */                               \
    ROW(root, Vec3<S>, roots, fixed, read, "roots", true)                                                  \
    /* [kg] with water */                                                                                  \
    ROW(mass, S, particles, water, read, "mass", true)                                                     \
    /* [m] of edges */                                                                                     \
    ROW(rest_length, S, particles, fixed, read, "rest lengths", true)                                      \
    /* tbar_i of edges, in the frame of the edge before; the first is unused */                            \
    ROW(target, Vec3<S>, particles, water, read, "bend targets", scene.term<Bend>().has_value())           \
    /* [N/m] of edges, [N/m] and [N m] of their joints with those before: of a fibre */                    \
    ROW(stretch_spring, S, particles, water, read, "stretch springs", scene.fibre&& scene.term<Stretch>()) \
    ROW(bend_spring, S, particles, water, read, "bend springs", scene.fibre&& scene.term<Bend>())          \
    ROW(twist_spring, S, particles, water, read, "twist springs", scene.fibre&& scene.term<Twist>())       \
    /* |bbar_i| of edges [m] */                                                                            \
    ROW(rest_core, S, particles, water, read, "core lengths", scene.term<Core>().has_value())              \
    /* sigma_i */                                                                                          \
    ROW(saturation, S, particles, water, read, "saturation",                                               \
        scene.wetness && (scene.term<Adhesion>() || scene.term<Stiffness>()))                              \
    /* [m] how deep a particle may lie in solids that move with the roots */                               \
    ROW(rest_depth, S, particles, fixed, read, "rest depth", scene.has_solid_with_roots())                 \
    /* [m] edges of the helix of Eq 9 as printed, its root-to-tip along x */                               \
    ROW(push, Vec3<S>, particles, water, coupling, "printed curl", scene.term<CurlPush>().has_value())     \
    /* [m/s] velocity of the air at particles */                                                           \
    ROW(air, Vec3<S>, particles, fixed, coupling, "air velocity", scene.term<AirDrag>().has_value())

// Array: what holds the values V of one of them, a vector or a pointer, empty or null where no present term
// needs it. S: a number, or a pack of them, a strand a lane.
template <class S, template <class V> class Array>
struct StateArrays {
#define WETCURL_ROW(name, type, ...) Array<type> name{};
    WETCURL_STATE_ARRAYS(WETCURL_ROW)
#undef WETCURL_ROW
};
template <class S, template <class V> class Array>
struct StrandArrays {
#define WETCURL_ROW(name, type, ...) Array<type> name{};
    WETCURL_STRAND_ARRAYS(WETCURL_ROW)
#undef WETCURL_ROW
};

// Calls f(info, array of each of `holders`...) for every array of a state, or of the strands.
#define WETCURL_ROW(name, type, extent, part, use, label, needed) \
    f(StrandArrayInfo{label, ArrayExtent::extent, StrandPart::part, BufferUse::use}, holders.name...);
template <class F, class... Holders>
void for_each_state_array(F f, Holders&... holders) {
    WETCURL_STATE_ARRAYS(WETCURL_ROW)
}
template <class F, class... Holders>
void for_each_strand_array(F f, Holders&... holders) {
    WETCURL_STRAND_ARRAYS(WETCURL_ROW)
}
#undef WETCURL_ROW

template <class V>
using HostArray = std::vector<V>;
template <class V>
using Pointer = V*;
template <class V>
using ConstPointer = const V*;

// Of pointers to arrays (strand, entry), where those of a strand of n particles begin.
template <class S, template <class V> class Array>
WETCURL_HD StrandArrays<S, ConstPointer> arrays_of(const StrandArrays<S, Array>& of, size_t strand, int n) {
    StrandArrays<S, ConstPointer> out;
#define WETCURL_ROW(name, type, extent, ...) \
    out.name =                               \
        of.name ? of.name + strand * (ArrayExtent::extent == ArrayExtent::roots ? 2 : size_t(n)) : nullptr;
    WETCURL_STRAND_ARRAYS(WETCURL_ROW)
#undef WETCURL_ROW
    return out;
}

}  // namespace wetcurl
