// Strands by some of their particles: every so-manieth from the root, and the tip. What is known of these
// goes over to the others linearly, and what the others hold goes to these by the same weights. And hair by
// some of its strands, which others see in the place of all.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/strands.h"
#include "solver/grooms/neighbourhood.h"
#include "solver/terms/cohesion.h"

namespace wetcurl {

struct Thinning {
    int particles;  // of a whole strand, 2 or more
    int every;      // 1: all; at most particles - 1
    int count;      // of a strand, who are asked
    double seen;    // share of the strands, 1: all

    explicit Thinning(int particles, int every = 1, double seen = 1)
        : particles(particles),
          every(every),
          count((particles - 2) / every + 2),
          seen(seen),
          inverse(1.f / float(every)) {}
    // As the term asks where strands lie as `rest` does.
    Thinning(const Strands& rest, const Cohesion& term)
        : Thinning(rest.particles, every_of(rest, term.spacing)) {
        if (term.neighbours == 0) return;
        const double all = Neighbourhood(rest).within(term.h_c) / every;
        if (all > term.neighbours) seen = term.neighbours / all;
    }
    bool is_whole() const { return every == 1 && seen == 1; }
    // Of any run of strands the same share is seen.
    bool sees(size_t strand) const {
        constexpr double golden = 0.61803398874989485;
        const double turns = double(strand) * golden;
        return turns - std::floor(turns) < seen;
    }

    // Where the j-th of a strand is. Strands take turns: asked at one height, all would draw together there.
    WETCURL_HD int at(int strand, int j) const { return after_turn(strand % every, j); }
    // Particle i of a strand lies between the `before`-th of them and the next, `after` of the way.
    struct Place {
        int before;
        float after;
    };
    WETCURL_HD Place place(int strand, int i) const {
        // The quotient of whole numbers below 2^20; their division takes a device far longer.
        const int turn = strand % every, by_turn = int((float(i + turn) + 0.5f) * inverse);
        const int j = by_turn < count - 2 ? by_turn : count - 2, begin = after_turn(turn, j);
        return {j, float(i - begin) / float(after_turn(turn, j + 1) - begin)};
    }
    // (strand, particle) to (strand, count): sums.
    std::vector<float> gathered(const std::vector<float>& whole) const {
        std::vector<float> sums(whole.size() / size_t(particles) * size_t(count));
        for (size_t k = 0; k < whole.size(); ++k) {
            const size_t strand = k / size_t(particles);
            const Place p = place(int(strand), int(k % size_t(particles)));
            float* sum = &sums[strand * size_t(count) + size_t(p.before)];
            sum[0] += (1 - p.after) * whole[k], sum[1] += p.after * whole[k];
        }
        return sums;
    }
    // The same, of these alone.
    std::vector<float> picked(const std::vector<float>& whole) const {
        std::vector<float> out;
        for (size_t s = 0; s < whole.size() / size_t(particles); ++s)
            for (int j = 0; j < count; ++j)
                out.push_back(whole[s * size_t(particles) + size_t(at(int(s), j))]);
        return out;
    }

  private:
    float inverse;  // of `every`

    static int every_of(const Strands& rest, double spacing) {
        double length = 0;
        for (int s = 0; s < rest.count; ++s) length += arc_length(rest.strand(s), rest.particles);
        const double edges = double(rest.count) * (rest.particles - 1);
        if (!(spacing > 0 && length > 0)) return 1;
        return int(std::clamp(std::round(spacing * edges / length), 1.0, double(rest.particles - 1)));
    }
    WETCURL_HD int after_turn(int turn, int j) const {
        return j == 0 ? 0 : j < count - 1 ? j * every - turn : particles - 1;
    }
};

// Of some particles, (strand, count): their own volume, and volume [m^3] and saturation of what each stands
// for; a strand that is not seen stands for nothing.
struct ThinnedWater {
    std::vector<float> own_volume, volume, saturation;
    ThinnedWater(const Thinning& thinning, const std::vector<float>& whole_volume,
                 std::vector<float> whole_saturation)
        : own_volume(thinning.picked(whole_volume)), volume(thinning.gathered(whole_volume)) {
        for (size_t k = 0; k < whole_volume.size(); ++k) whole_saturation[k] *= whole_volume[k];
        saturation = thinning.gathered(whole_saturation);
        for (size_t k = 0; k < volume.size(); ++k) {
            saturation[k] /= volume[k];
            if (thinning.seen < 1)
                volume[k] *= thinning.sees(k / size_t(thinning.count)) ? float(1 / thinning.seen) : 0.f;
        }
    }
};

}  // namespace wetcurl
