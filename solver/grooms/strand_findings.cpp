// Sanity of strands.
#include "solver/grooms/strand_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/geometry/file_frame.h"
#include "base/median.h"
#include "base/number_text.h"
#include "base/strands.h"
#include "solver/grooms/stray_points.h"

namespace wetcurl {

using Level = Finding::Level;

namespace {

void find_size(std::vector<Finding>& out, double length, const std::string& file, const std::string& units) {
    constexpr double shortest = 1e-3, short_hair = 5e-3, long_hair = 3, longest = 10;  // [m]
    if (length >= short_hair && length <= long_hair) {
        out.push_back(
            {Level::note, "size",
             fmt::format("{}: strands are {:.3g} m long in the median, taken as {}", file, length, units),
             ""});
        return;
    }
    const bool spoils = length < shortest || length > longest;
    out.push_back(
        {spoils ? Level::error : Level::warning, "size",
         fmt::format("{}: strands are {:.3g} m long in the median, taken as {}", file, length, units),
         fmt::format("units = \"{}\" in [groom], if that is the unit of the file",
                     length > 1 ? (length > 100 ? "mm" : "cm") : "m")});
}

void find_stray_points(std::vector<Finding>& out, const ImportedStrands& in, const std::string& file) {
    const StraySearch search(in);
    std::vector<size_t> stray;
    for (size_t s = 0; s < in.strands.size(); ++s)
        if (search.first_in(in.strands[s])) stray.push_back(in.numbers[s]);
    if (!stray.empty())
        out.push_back(
            {Level::error, "stray_points",
             fmt::format("{}: {} of {} strands have a point far from the others or at the origin: strand {}",
                         file, stray.size(), in.strands.size(), listed(stray, 8)),
             "repair = true in [groom], which leaves such points out"});
}

// How a strand turns back by more than 120 degrees: at what share of its inner points, and how long its
// segments are in the mean, as a share of how far it reaches. Few points on a tight coil do so too, by short
// ones.
struct TurnsBack {
    double points = 0, segment = 0;
    explicit TurnsBack(const std::vector<Vec3d>& strand) {
        size_t sharp = 0;
        double reach = 0;
        for (size_t i = 1; i < strand.size(); ++i) {
            reach = std::max(reach, norm(strand[i] - strand[0]));
            if (i + 1 == strand.size()) continue;
            const Vec3d a = strand[i] - strand[i - 1], b = strand[i + 1] - strand[i];
            sharp += dot(a, b) < -0.5 * norm(a) * norm(b);
        }
        if (sharp < 2) return;
        points = double(sharp) / double(strand.size() - 2);
        segment = arc_length(strand.data(), int(strand.size())) / double(strand.size() - 1) / reach;
    }
};

// The strand's longest segment over its median one; 0 where it is no tenth of the strand.
double longest_of_usual(const std::vector<Vec3d>& strand) {
    const Segments segments(strand);
    const double longest = std::ranges::max(segments.lengths);
    return longest > 0.1 * arc_length(strand.data(), int(strand.size())) ? longest / segments.usual : 0;
}

// Points of a strand against each other.
void find_odd_points(std::vector<Finding>& out, const ImportedStrands& in, const std::string& file) {
    constexpr double often = 1.0 / 3, far = 0.2, much = 10, spoilt = 0.2;
    std::vector<size_t> turned, uneven;
    size_t far_turned = 0;
    double most = 0;
    for (size_t s = 0; s < in.strands.size(); ++s) {
        if (const TurnsBack back(in.strands[s]); back.points > often) {
            turned.push_back(in.numbers[s]);
            far_turned += back.segment > far;
        }
        const double longest = longest_of_usual(in.strands[s]);
        if (longest > much) uneven.push_back(in.numbers[s]);
        most = std::max(most, longest);
    }
    const double strands = double(in.strands.size());
    if (!turned.empty())
        out.push_back(
            {double(far_turned) > spoilt * strands ? Level::error : Level::warning, "point_order",
             fmt::format("{}: {} of {} strands turn back by more than 120 degrees at a third of their "
                         "points or more: strand {}",
                         file, turned.size(), in.strands.size(), listed(turned, 8)),
             "a file with the points of each strand in order from root to tip, or with more of them where it "
             "coils"});
    if (!uneven.empty())
        out.push_back(
            {Level::warning, "long_segments",
             fmt::format(
                 "{}: {} of {} strands have a segment of more than {:g} times their median one, {:.3g} "
                 "times at most: strand {}",
                 file, uneven.size(), in.strands.size(), much, most, listed(uneven, 8)),
             "a file in which they are strands of their own, if strands are joined there"});
}

// Against the median strand.
void find_odd_lengths(std::vector<Finding>& out, const ImportedStrands& in, const std::string& file,
                      const std::vector<double>& lengths, double usual) {
    constexpr double short_share = 0.02, long_share = 10;
    const auto find = [&](const char* name, const char* than, double limit, const auto& is_odd) {
        std::vector<size_t> numbers;
        for (size_t s = 0; s < lengths.size(); ++s)
            if (is_odd(lengths[s], limit)) numbers.push_back(in.numbers[s]);
        if (!numbers.empty())
            out.push_back(
                {Level::warning, name,
                 fmt::format("{}: {} strands are {} than {:.3g} mm, {:g} times the median one: "
                             "strand {}",
                             file, numbers.size(), than, 1e3 * limit, limit / usual, listed(numbers, 8)),
                 ""});
    };
    find("short_strands", "shorter", short_share * usual, std::less<>());
    find("long_strands", "longer", long_share * usual, std::greater<>());
}

// Without a sign of its own for 0.
double hundredths(double x) { return 0.01 * std::round(100 * x) + 0.0; }

// The axis of the file that points up where hair falls along `way`, as it is when the file is read with `up`
// up.
std::string axis_by_fall(const std::string& up, const Vec3d& way) {
    const Vec3d in_file = laid_along(up, way);
    std::string best;
    double most = -1e300;
    for (const char* axis : axis_words)
        if (axis != std::string("auto"))
            if (const double fall = -upright(axis, in_file).y; fall > most) most = fall, best = axis;
    return best;
}

// Hair falls: from roots to tips mostly downward.
void find_up(std::vector<Finding>& out, const ImportedStrands& in, const std::string& file) {
    if (!in.up_reason.empty()) {
        out.push_back({Level::warning, "up",
                       fmt::format("{}: up axis not given, guessed {} ({})", file, in.up, in.up_reason),
                       fmt::format("up = \"{}\" in [groom] says so", in.up)});
        return;
    }
    Vec3d fall{0, 0, 0};
    double sum = 0;
    for (const auto& strand : in.strands)
        fall += strand.back() - strand.front(), sum += norm(strand.back() - strand.front());
    const auto is_well = [&](const std::string& what) {
        out.push_back({Level::note, "up", fmt::format("{}: {} is up; {}", file, in.up, what), ""});
    };
    if (sum == 0 || norm(fall) < 0.3 * sum) return is_well("from roots to tips the hair goes every way");
    const Vec3d way = (1 / norm(fall)) * fall;
    if (std::max(std::abs(way.x), std::abs(way.z)) < 0.8 && way.y < 0.8)
        return is_well(fmt::format("from roots to tips the hair runs along ({:.2g}, {:.2g}, {:.2g})",
                                   hundredths(way.x), hundredths(way.y), hundredths(way.z)));
    const char* along = way.y > 0.8              ? "+y"
                        : std::abs(way.x) >= 0.8 ? (way.x < 0 ? "-x" : "+x")
                                                 : (way.z < 0 ? "-z" : "+z");
    const std::string hangs = "up = \"" + axis_by_fall(in.up, way) + "\"";
    out.push_back(
        {Level::warning, "up",
         fmt::format("{}: read with {} up, the hair runs along {} from roots to tips", file, in.up, along),
         way.y > 0.8 ? "order = \"tip_first\" or " + hangs + " in [groom], if hair should hang down"
                     : hangs + " in [groom], if the file is drawn so"});
}

}  // namespace

const char* name_of(Finding::Level level) {
    constexpr const char* names[] = {"note", "warning", "error"};
    return names[size_t(level)];
}

std::string described(const Finding& f) {
    return fmt::format("{}: {}{}", f.name, f.text, f.remedy.empty() ? "" : "; " + f.remedy);
}

std::vector<Finding> findings_of_strands(const ImportedStrands& in, const std::string& file) {
    std::vector<Finding> out;
    std::vector<double> lengths;
    for (const auto& strand : in.strands) lengths.push_back(arc_length(strand.data(), int(strand.size())));
    const double length = median(lengths);
    find_size(out, length, file, in.units);
    find_stray_points(out, in, file);
    find_odd_points(out, in, file);
    find_odd_lengths(out, in, file, lengths, length);
    find_up(out, in, file);
    return out;
}

Finding finding_of_turns(const CurlTurns& curl, int particles) {
    if (curl.turns < 1) return {Level::note, "few_particles", "the hair has no curls to show", ""};
    const double of_a_turn = (particles - 1) / curl.turns;
    const int enough = enough_particles(curl);
    const bool few = particles < enough;
    return {few ? Level::warning : Level::note, "few_particles",
            fmt::format(
                "found {} particles a strand for curls of {:.1f} turns and {:.1f} mm radius, {:.1f} a turn{}",
                particles, curl.turns, 1e3 * curl.radius, of_a_turn,
                !few                                     ? ""
                : of_a_turn < fewest_particles_of_a_turn ? ": no such strand shows its curl"
                                                         : ": they are coarse"),
            few ? fmt::format("particles = {} in [groom] gives the {:g} that keep their shape", enough,
                              enough_particles_of_a_turn)
                : ""};
}

}  // namespace wetcurl
