// The channels of what networks see and predict, by name: how many there are and where each group begins. The
// one place that says so: codecs and kernels, pairs files, recipes and model cards read it here.
//
// Codec strand: a pixel of the root grid is a strand. The input is the image that stays, "static", then that
// of a frame, "dynamic"; the output holds amplitudes. Vectors are in the strand's root frame
// (learn/codec/root_frame.h). Pixels without a strand hold zeros. All numbers are without units: lengths by
// the strand's own L, times by T = sqrt(L / g), in which a pendulum of it swings, accelerations by g.
// Codec root: a pixel is a root, its colour three channels (learn/codec/root_codec.h).
// Codec adhesion: one particle and its two neighbours along the strand (Section IV.D, Eq 20).
#pragma once

#include <array>

#include "base/host_device.h"

namespace wetcurl {

// Channels that lie side by side.
struct Channels {
    int first, count;
    constexpr int end() const { return first + count; }
    constexpr bool holds(int channel) const { return first <= channel && channel < end(); }
};
constexpr Channels after(const Channels& others, int count) { return {others.end(), count}; }
constexpr Channels from_to(const Channels& begin, const Channels& last) {
    return {begin.first, last.end() - begin.first};
}

// ---- codec strand ----

inline constexpr int dct_kept = 24;                       // amplitudes an axis (learn/codec/dct.h)
inline constexpr int strand_coefficients = 3 * dct_kept;  // of a strand: channel = dct_kept * axis + k

inline constexpr int saturation_pieces = 8;                    // equal parts of a strand, root first
inline constexpr std::array<int, 4> history_lags{1, 2, 4, 8};  // [1/24 s] before the frame
inline constexpr int history_fps = 24;
inline constexpr int history_modes = 4;  // amplitudes an axis whose change is seen

inline constexpr int doubt_places = 3;            // equally far apart, the tip the last
inline constexpr float standard_gravity = 9.81f;  // g [m/s^2]

// Channel of the amplitude that is number `m` of the 3 history_modes.
WETCURL_HD constexpr int history_amplitude(int m) { return m / history_modes * dct_kept + m % history_modes; }

// "static" (static_channels, H, W).
struct StaticChannels {
    Channels rest{0, strand_coefficients};                 // amplitudes of the rest shape with its water [L]
    Channels saturation = after(rest, saturation_pieces);  // means over the pieces
    Channels radius = after(saturation, 1);                // of its curl at rest [L]
    Channels scalp = after(radius, 1);                     // root mean square distance of the roots from
                                                           // their middle [L]
    Channels spacing = after(scalp, 1);                    // mean distance to the roots beside it [L]
    Channels reach = after(spacing, 1);                    // of Eq 10 [L], 0 without it
    // Of the low-resolution strands around it: how far their roots lie [L], how far their cores at rest are
    // from its own [L], how much the heaviest counts, how far they lie from those beside them [L].
    Channels guides = after(reach, 4);
    // Of the fibre: the logarithm of EI / (weight L²), dry, and how much water changes that; the mass of a
    // drenched strand by that of a dry one; drag, dry and wet [1/T]; a step of the low-resolution run [T].
    Channels fibre = after(guides, 6);
    int count = fibre.end();
};
inline constexpr StaticChannels static_layout;

// A strand at a frame before. Before the first frame all was as in it.
struct PastChannels {
    Channels change{0, 3 * history_modes};      // of the base's first amplitudes since then [L]
    Channels turning = after(change, 3);        // as of DynamicChannels, then
    Channels acceleration = after(turning, 3);  // as of DynamicChannels, then
    int count = acceleration.end();
};
inline constexpr PastChannels past_layout;

// "dynamic" (dynamic_channels, H, W), of a frame.
struct DynamicChannels {
    Channels base{0, strand_coefficients};      // amplitudes of the base [L]
    Channels gravity = after(base, 3);          // [g]
    Channels turning = after(gravity, 3);       // angular velocity of the head [1/T]
    Channels acceleration = after(turning, 3);  // of the root [g]
    // How differently the low-resolution strands around it have moved, at doubt_places of it [L], and how
    // much they have lost of what is their own (learn/codec/carried_rest.h).
    Channels doubt = after(acceleration, doubt_places + 1);
    Channels history = after(doubt, int(history_lags.size()) * past_layout.count);  // lag by lag
    int count = history.end();
    // Of the frame history_lags[lag] before.
    constexpr Channels past(int lag) const {
        return {history.first + lag * past_layout.count, past_layout.count};
    }
};
inline constexpr DynamicChannels dynamic_layout;
static_assert(dynamic_layout.base.first == 0);  // pairs files begin with the base

inline constexpr int static_channels = static_layout.count, dynamic_channels = dynamic_layout.count,
                     strand_channels = static_channels + dynamic_channels;  // of a network's input

// What a network answers: what is to be added to the base's amplitudes [L], and how far the strands that come
// of it are expected to be off, root first: the logarithm of the mean distance of each piece, by usual_error.
inline constexpr int error_pieces = 8;       // equal parts of a strand
inline constexpr float usual_error = 0.01f;  // [L]
inline constexpr Channels answered_amplitudes{0, strand_coefficients},
    answered_errors = after(answered_amplitudes, error_pieces);
inline constexpr int strand_outputs = answered_errors.end();

// What a recipe can leave out of the input, by name.
struct InputGroup {
    const char* name;
    Channels channels;  // of the input
};
constexpr Channels in_input(const Channels& dynamic) {
    return {static_channels + dynamic.first, dynamic.count};
}
inline constexpr std::array<InputGroup, 12> strand_inputs{{
    {"rest", static_layout.rest},
    {"saturation", static_layout.saturation},
    {"radius", static_layout.radius},
    {"scalp", static_layout.scalp},
    {"density", from_to(static_layout.spacing, static_layout.reach)},
    {"guides", static_layout.guides},
    {"fibre", static_layout.fibre},
    {"base", in_input(dynamic_layout.base)},
    {"gravity", in_input(dynamic_layout.gravity)},
    {"motion", in_input(from_to(dynamic_layout.turning, dynamic_layout.acceleration))},
    {"doubt", in_input(dynamic_layout.doubt)},
    {"history", in_input(dynamic_layout.history)},
}};

// The same in finer parts, as people are told of them.
constexpr Channels one_of(const Channels& group, int k) { return {group.first + k, 1}; }
inline constexpr std::array<InputGroup, 22> told_inputs{{
    {"rest shape", static_layout.rest},
    {"saturation", static_layout.saturation},
    {"curl radius", static_layout.radius},
    {"size of the scalp", static_layout.scalp},
    {"spacing of strands", static_layout.spacing},
    {"reach of Eq 10", static_layout.reach},
    {"distance of guides", one_of(static_layout.guides, 0)},
    {"unlikeness of guides", one_of(static_layout.guides, 1)},
    {"weight of the first guide", one_of(static_layout.guides, 2)},
    {"spacing of guides", one_of(static_layout.guides, 3)},
    {"stiffness", one_of(static_layout.fibre, 0)},
    {"softening by water", one_of(static_layout.fibre, 1)},
    {"mass of water", one_of(static_layout.fibre, 2)},
    {"drag when dry", one_of(static_layout.fibre, 3)},
    {"drag when wet", one_of(static_layout.fibre, 4)},
    {"step of the low-resolution run", one_of(static_layout.fibre, 5)},
    {"base", in_input(dynamic_layout.base)},
    {"gravity", in_input(dynamic_layout.gravity)},
    {"turning", in_input(dynamic_layout.turning)},
    {"acceleration", in_input(dynamic_layout.acceleration)},
    {"doubt", in_input(dynamic_layout.doubt)},
    {"history", in_input(dynamic_layout.history)},
}};

// ---- codec root ----

inline constexpr int colour_channels = 3;  // x, y, z (Eq 14)

// ---- codec adhesion ----

// The numbers of each of the particles i-1, i and i+1, in this order.
struct AdhesionChannels {
    static constexpr int contact = 0,  // 1 in contact
        speed = 1,                     // v.n / sqrt(a_max h)
        distance = 2,                  // phi / h
        force = 3,                     // F.n / (sigma m a_max) of the step before
        of_particle = 4, particles = 3;
    // Where those of particle i + side begin; side -1, 0 or 1.
    WETCURL_HD static constexpr int first(int side) { return of_particle * (side + 1); }
};
inline constexpr int adhesion_inputs = AdhesionChannels::particles * AdhesionChannels::of_particle;

}  // namespace wetcurl
