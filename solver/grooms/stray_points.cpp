// Points that are no part of their strands.
#include "solver/grooms/stray_points.h"

#include <algorithm>

#include "base/median.h"

namespace wetcurl {

Segments::Segments(const std::vector<Vec3d>& strand) {
    for (size_t i = 0; i + 1 < strand.size(); ++i) lengths.push_back(norm(strand[i + 1] - strand[i]));
    usual = median(lengths);
}

double Segments::length_without_jumps() const {
    double sum = 0;
    for (size_t i = 0; i < lengths.size(); ++i) sum += is_jump(i) ? 0 : lengths[i];
    return sum;
}

namespace {

constexpr double far_from_origin = 1e-3;  // [m]
constexpr double share_of_strand = 0.25, share_of_strands = 0.2;

}  // namespace

StraySearch::StraySearch(const ImportedStrands& in) : origin_(in.origin) {
    std::vector<double> lengths, jumps, roots;
    for (const auto& strand : in.strands) {
        const Segments segments(strand);
        lengths.push_back(segments.length_without_jumps());
        jumps.push_back(0);
        for (size_t i = 0; i < segments.lengths.size(); ++i)
            if (segments.is_jump(i)) jumps.back() = std::max(jumps.back(), segments.lengths[i]);
        roots.push_back(norm(strand.front() - origin_));
    }
    usual_length_ = median(lengths);
    roots_elsewhere_ = median(roots) > 0.01;  // [m]
    const auto jumping = std::ranges::count_if(
        jumps, [&](double longest) { return longest > share_of_strand * usual_length_; });
    jumps_ = jumping <= 3 || double(jumping) < share_of_strands * double(in.strands.size());
}

std::optional<StrayPoints> StraySearch::first_in(const std::vector<Vec3d>& strand) const {
    const size_t n = strand.size();
    if (n > 1 && roots_elsewhere_ && at_origin(strand[0])) return StrayPoints{0, 1};
    const Segments segments(strand);
    const auto& lengths = segments.lengths;
    for (size_t i = 0; i + 1 < n; ++i) {
        if (at_origin(strand[i + 1]) && norm(strand[i] - origin_) > far_from_origin) {
            size_t last = i + 2;
            while (last < n && at_origin(strand[last])) ++last;
            return StrayPoints{i + 1, last};
        }
        for (size_t back = i + 1; segments.is_long(i) && back < std::min(i + 4, lengths.size()); ++back)
            if (segments.is_long(back) &&
                norm(strand[back + 1] - strand[i]) < 0.25 * std::min(lengths[i], lengths[back]))
                return StrayPoints{i + 1, back + 1};
        if (jumps_ && segments.is_jump(i) && lengths[i] > share_of_strand * usual_length_)
            return StrayPoints{i + 1, n};
    }
    return std::nullopt;
}

Repaired repair(ImportedStrands& in) {
    const StraySearch search(in);
    Repaired out;
    std::vector<size_t> kept;
    for (size_t s = 0; s < in.strands.size(); ++s) {
        bool is_changed = false;
        const auto leave_out = [](auto& points, const StrayPoints& stray) {
            points.erase(points.begin() + long(stray.first), points.begin() + long(stray.last));
        };
        while (const auto stray = search.first_in(in.strands[s])) {
            leave_out(in.strands[s], *stray);
            if (!in.widths.empty()) leave_out(in.widths[s], *stray);
            out.points += stray->last - stray->first;
            is_changed = true;
        }
        out.strands += is_changed;
        if (in.strands[s].size() > 1) kept.push_back(s);
    }
    if (kept.size() == in.strands.size()) return out;
    auto keep = [&](auto& values) {
        if (values.empty()) return;
        for (size_t k = 0; k < kept.size(); ++k) values[k] = values[kept[k]];
        values.resize(kept.size());
    };
    in.one_point += in.strands.size() - kept.size();
    keep(in.strands), keep(in.numbers), keep(in.widths), keep(in.ids), keep(in.groups), keep(in.root_uv);
    return out;
}

}  // namespace wetcurl
