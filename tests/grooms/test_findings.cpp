// What looks wrong about hair and head is found, named and mended; what is right is left alone.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "solver/grooms/groom.h"
#include "solver/grooms/procedural.h"
#include "solver/scene/findings.h"
#include "strand_files.h"

namespace wetcurl {
namespace {

using namespace testing;

// Hair that falls from a ball of 0.1 m: roots on its upper half, tips 0.2 m below.
StrandPoints falling(int count, double scale = 1) {
    StrandPoints out;
    for (int s = 0; s < count; ++s) {
        const double a = 2.399963 * s, r = 0.09 * std::sqrt((s + 0.5) / count);
        const Vec3d root{r * std::cos(a), std::sqrt(0.01 - r * r), r * std::sin(a)};
        const Vec3d out_of_it{2.2 * root.x, 0, 2.2 * root.z};
        std::vector<Vec3d> strand;
        for (int i = 0; i < 12; ++i) {
            const double t = i / 11.0;
            strand.push_back(scale * (root + std::min(1.0, 3 * t) * (out_of_it - Vec3d{root.x, 0, root.z}) +
                                      Vec3d{0, 0.02 * t - 0.22 * t * t, 0}));
        }
        out.push_back(strand);
    }
    return out;
}

constexpr const char* head =
    "[[solid]]\nname = \"head\"\nattached = \"head\"\nshape = \"sphere\"\nradius = 0.095\n";

class Findings : public ::testing::Test {
  protected:
    Scene scene_of(const StrandPoints& strands, const std::string& groom = "", const std::string& rest = head,
                   bool stop = false) {
        scratch.file("groom.data", data_file(strands));
        const std::string path = scratch.file(
            "scene.toml", above + "[groom]\nfile = \"groom.data\"\nunits = \"m\"\nparticles = 12\n" + groom +
                              "\n[stretch]\n[bend]\n" + rest);
        SceneOptions options;
        options.findings_stop = stop;
        return load_scene(path, options);
    }
    std::set<std::string> found(const StrandPoints& strands, const std::string& groom = "",
                                const std::string& rest = head) {
        std::set<std::string> out;
        for (const auto& finding : findings_of(scene_of(strands, groom, rest)))
            if (finding.level != Finding::Level::note) out.insert(finding.name);
        return out;
    }
    // Texts of the findings of that name, one a line.
    static std::string texts(const Scene& scene, const std::string& name) {
        std::string out;
        for (const auto& finding : findings_of(scene))
            if (finding.name == name)
                out += std::string(name_of(finding.level)) + ": " + described(finding) + "\n";
        return out;
    }
    using Names = std::set<std::string>;
    Scratch scratch;
    std::string above;  // the first table
};

TEST_F(Findings, are_none_where_all_is_well) {
    EXPECT_EQ(found(falling(200)), Names{});
    EXPECT_EQ(found(falling(200), "", ""), Names{});
    EXPECT_NO_THROW(scene_of(falling(200), "", head, true));
}

TEST_F(Findings, say_of_good_hair_its_size_axis_curls_and_roots) {
    const Scene scene = scene_of(falling(200));
    EXPECT_NE(texts(scene, "size").find("m long in the median, taken as m"), std::string::npos);
    EXPECT_NE(texts(scene, "up").find("y is up; from roots to tips the hair runs along (0, -1, 0)"),
              std::string::npos)
        << texts(scene, "up");
    EXPECT_NE(texts(scene, "few_particles").find("note: few_particles"), std::string::npos);
    EXPECT_NE(texts(scene, "roots_off_head").find("note: roots_off_head: roots lie 5 mm from the head"),
              std::string::npos)
        << texts(scene, "roots_off_head");
}

// A ball of 0.095 m, and one of 0.05 m around the same middle: roots lie 5 and 50 mm from them.
TEST_F(Findings, say_how_roots_lie_on_each_solid_that_is_attached) {
    const std::string found = texts(
        scene_of(falling(200), "",
                 std::string(head) +
                     "[[solid]]\nname = \"core\"\nattached = \"head\"\nshape = \"sphere\"\nradius = 0.05\n"
                     "[[solid]]\nname = \"elsewhere\"\nshape = \"sphere\"\nradius = 0.05\n"),
        "roots_off_head");
    for (const char* part : {"roots lie 5 mm from [[solid]] 'head' in the median",
                             "roots lie 50 mm from [[solid]] 'core' in the median"})
        EXPECT_NE(found.find(part), std::string::npos) << found;
    EXPECT_EQ(found.find("elsewhere"), std::string::npos) << found;
}

TEST_F(Findings, tips_that_come_first_are_seen_and_turned) {
    StrandPoints strands = falling(200);
    for (auto& strand : strands) std::reverse(strand.begin(), strand.end());
    EXPECT_TRUE(found(strands).contains("order"));
    expect_error([&] { scene_of(strands, "", head, true); }, {"order", "tip_first", "allow = "});
    EXPECT_EQ(found(strands, "order = \"tip_first\""), Names{});
    above = "allow = [\"order\"]\n";
    EXPECT_NO_THROW(scene_of(strands, "", head, true));
}

TEST_F(Findings, some_strands_that_are_turned_are_seen_and_roots_in_the_head_say_nothing_of_tips) {
    StrandPoints strands = falling(200);
    for (size_t s = 0; s < 40; ++s) std::reverse(strands[5 * s].begin(), strands[5 * s].end());
    EXPECT_TRUE(found(strands).contains("order"));
    EXPECT_NE(texts(scene_of(strands), "order").find("strands 20, 25, 30, 35"), std::string::npos)
        << texts(scene_of(strands), "order");
    EXPECT_NO_THROW(scene_of(strands, "", head, true));  // a warning
    // A head that is three times too large.
    std::string large = head;
    large.replace(large.find("0.095"), 5, "0.285");
    const Names names = found(falling(200), "", large);
    EXPECT_FALSE(names.contains("order"));
    EXPECT_TRUE(names.contains("roots_off_head"));
}

TEST_F(Findings, an_axis_that_is_up_is_guessed_by_the_fall_of_hair) {
    const StrandPoints upright = falling(200);
    StrandPoints strands = upright;
    for (auto& strand : strands)
        for (auto& x : strand) x = {x.x, -x.z, x.y};  // z up
    EXPECT_EQ(found(strands), Names{"up"});
    EXPECT_EQ(found(strands, "up = \"z\""), Names{});
    const Strands wanted = scene_of(upright).groom.rest, guessed = scene_of(strands).groom.rest;
    ASSERT_EQ(guessed.count, wanted.count);
    for (size_t k = 0; k < wanted.points.size(); ++k)
        EXPECT_LT(norm(guessed.points[k] - wanted.points[k]), 1e-6f);
    EXPECT_TRUE(found(strands, "up = \"y\"").contains("up"));
    // Said wrongly, the axis that lets it fall is named.
    for (const char* wrong : {"up = \"z\"", "up = \"-z\"", "up = \"x\""}) {
        const std::string said = texts(scene_of(upright, wrong), "up");
        EXPECT_NE(said.find("up = \"y\" in [groom]"), std::string::npos) << wrong << ": " << said;
    }
    EXPECT_NE(texts(scene_of(strands, "up = \"y\""), "up").find("up = \"z\" in [groom]"), std::string::npos);
}

// Its roots lie on the upper side of a head that is drawn y up.
TEST_F(Findings, hair_that_is_combed_back_does_not_turn_the_head) {
    StrandPoints strands = falling(200);
    for (auto& strand : strands)
        for (auto& x : strand) {
            const Vec3d root = strand.front(), way = x - root;
            if (&x != &strand.front())
                x = root + Vec3d{way.x, 0.3 * way.y, -std::abs(way.y) - std::abs(way.z)};
        }
    const Scene scene = scene_of(strands);
    Vec3d highest{0, -1, 0};
    for (int s = 0; s < scene.groom.rest.count; ++s)
        if (const Vec3d root = cast<double>(scene.groom.rest.at(s, 0)); root.y > highest.y) highest = root;
    EXPECT_GT(highest.y, 0.09);
}

TEST_F(Findings, stray_points_are_named_by_their_strand_and_left_out) {
    StrandPoints strands = falling(200);
    strands[7].back() = {0, 0, 0};
    strands[31][6] = {0, 40, 0};
    expect_error([&] { scene_of(strands, "", head, true); },
                 {"stray_points", "strand 7, 31", "repair = true"});
    const Scene scene = scene_of(strands, "repair = true", head, true);
    EXPECT_EQ(scene.groom.rest.count, 200);
    for (const auto& x : scene.groom.rest.points) EXPECT_LT(norm(x), 1);
}

// Of 12 points over 0.2 m; all but the stray ones stay.
TEST_F(Findings, a_detour_and_a_root_at_the_origin_are_left_out_alone) {
    const StrandPoints whole = falling(200);
    StrandPoints strands = whole;
    strands[7][6] += {0.4, 0, 0};
    strands[8][6] += {0, 0.4, 0}, strands[8][7] += {0, 0.4, 0};
    strands[9].front() = {0, 0, 0};
    strands[10][4] = {0, 0, 0};
    expect_error([&] { scene_of(strands, "", head, true); }, {"stray_points", "strand 7, 8, 9, 10"});
    // Placed elsewhere, the file's origin is no scene's.
    expect_error([&] { scene_of(strands, "offset = [0, 0, 0.001]", head, true); },
                 {"stray_points", "strand 7, 8, 9, 10"});
    scratch.file("groom.data", data_file(strands));
    GroomTable table;
    table.file = scratch.path("groom.data"), table.units = "m", table.up = "y", table.repair = true;
    const ImportedStrands in = import_strands(table);
    for (const auto& [s, first, count] : {std::array<size_t, 3>{7, 6, 1}, {8, 6, 2}, {9, 0, 1}, {10, 4, 1}}) {
        std::vector<Vec3d> kept = whole[s];
        kept.erase(kept.begin() + long(first), kept.begin() + long(first + count));
        ASSERT_EQ(in.strands[s].size(), kept.size()) << s;
        for (size_t i = 0; i < kept.size(); ++i) EXPECT_LT(norm(in.strands[s][i] - kept[i]), 1e-6) << s;
    }
}

// Many points in a curl at the tip, one segment before it, as programs simplify curves.
TEST_F(Findings, strands_of_very_uneven_segments_are_not_stray) {
    StrandPoints strands = falling(200);
    for (auto& strand : strands) {
        const Vec3d tip = strand.back();
        strand = {strand.front(), strand.front() + 0.9 * (tip - strand.front())};
        const Vec3d at = strand.back();
        for (int i = 1; i <= 40; ++i) strand.push_back(at + (i / 40.0) * (tip - at));
    }
    EXPECT_FALSE(found(strands).contains("stray_points"));
}

TEST_F(Findings, points_in_a_wrong_order_are_seen_without_a_head_too) {
    // Taken alternately from both ends.
    const auto mixed = [](const std::vector<Vec3d>& strand) {
        std::vector<Vec3d> out;
        for (size_t i = 0, j = strand.size(); i < j;) {
            out.push_back(strand[i++]);
            if (i < j) out.push_back(strand[--j]);
        }
        return out;
    };
    StrandPoints strands = falling(200);
    for (size_t s : {3, 50}) strands[s] = mixed(strands[s]);
    EXPECT_EQ(found(strands, "", ""), Names{"point_order"});
    EXPECT_NE(texts(scene_of(strands, "", ""), "point_order").find("warning: point_order"),
              std::string::npos);
    EXPECT_NE(texts(scene_of(strands, "", ""), "point_order").find("strand 3, 50"), std::string::npos);
    for (auto& strand : strands) strand = mixed(strand);
    expect_error([&] { scene_of(strands, "", "", true); }, {"point_order", "120 degrees", "allow = "});
}

// Three points a turn.
TEST_F(Findings, a_coarse_coil_is_a_warning_alone) {
    StrandPoints strands = falling(200);
    for (auto& strand : strands) {
        const Vec3d root = strand.front();
        strand.clear();
        for (int i = 0; i < 60; ++i)
            strand.push_back(root +
                             Vec3d{0.003 * std::cos(2.6 * i) - 0.003, -0.002 * i, 0.003 * std::sin(2.6 * i)});
    }
    EXPECT_TRUE(found(strands, "", "").contains("point_order"));
    EXPECT_NO_THROW(scene_of(strands, "", "", true));
}

TEST_F(Findings, strands_that_are_joined_have_a_long_segment) {
    StrandPoints strands = falling(200), joined;
    for (size_t s = 0; s < 200; s += 2) {
        joined.push_back(strands[s]);
        joined.back().insert(joined.back().end(), strands[s + 1].begin(), strands[s + 1].end());
    }
    EXPECT_TRUE(found(joined, "", "").contains("long_segments"));
    strands[199].insert(strands[199].end(), strands[198].begin(), strands[198].end());
    EXPECT_NE(texts(scene_of(strands, "", ""), "long_segments").find("1 of 200 strands"), std::string::npos);
    EXPECT_NE(texts(scene_of(strands, "", ""), "long_segments").find("strand 199"), std::string::npos);
}

TEST_F(Findings, hair_that_starts_far_from_its_head_stops_the_scene) {
    expect_error([&] { scene_of(falling(100), "offset = [1, 0, 0]", head, true); },
                 {"roots_off_head", "[groom]"});
    EXPECT_EQ(found(falling(100), "offset = [0.1, 0, 0]"), Names{"roots_off_head"});
}

TEST_F(Findings, single_strands_far_from_the_head_stop_the_scene_and_are_named) {
    StrandPoints strands = falling(50);
    for (const size_t s : {7u, 31u})
        for (auto& x : strands[s]) x.z += 0.9;
    expect_error([&] { scene_of(strands, "", head, true); },
                 {"2 of 50 roots", "strands 7, 31", "roots_off_head"});
}

TEST_F(Findings, a_head_in_another_unit_stops_the_scene) {
    const std::string giant =
        "[[solid]]\nname = \"head\"\nattached = \"head\"\nshape = \"sphere\"\nradius = 9.5\n";
    EXPECT_TRUE(found(falling(100), "", giant).contains("head_size"));
    expect_error([&] { scene_of(falling(100), "", giant, true); }, {"head"});
}

TEST_F(Findings, hair_of_no_size_that_hair_has_is_seen) {
    EXPECT_TRUE(found(falling(100, 100), "", "").contains("size"));
    EXPECT_TRUE(found(falling(100, 0.001), "", "").contains("size"));
    EXPECT_EQ(found(falling(100, 100), "scale = 0.01", ""), Names{});
}

TEST_F(Findings, short_strands_are_counted_and_named) {
    StrandPoints strands = falling(100);
    strands[5] = {{0, 0.1, 0}, {0, 0.101, 0}, {0, 0.102, 0}};
    const Scene scene = scene_of(strands);
    const auto all = findings_of(scene);
    const auto at = std::find_if(all.begin(), all.end(),
                                 [](const Finding& f) { return f.name == std::string("short_strands"); });
    ASSERT_NE(at, all.end());
    EXPECT_NE(at->text.find("strand 5"), std::string::npos);
}

TEST_F(Findings, strands_that_are_far_longer_than_the_others_are_named) {
    StrandPoints strands = falling(100);
    for (size_t i = 1; i < strands[5].size(); ++i)
        strands[5][i] = strands[5].front() + Vec3d{0, -0.25 * double(i), 0};
    const std::string said = texts(scene_of(strands), "long_strands");
    EXPECT_NE(said.find("warning: long_strands"), std::string::npos) << said;
    EXPECT_NE(said.find("strand 5"), std::string::npos) << said;
}

// A box over the crown, in which a tenth of the roots lies more than 8 mm deep, or none.
TEST_F(Findings, roots_deep_in_a_solid_beside_the_head_are_seen) {
    const auto with_box = [&](double bottom) {
        std::string box;
        for (const double y : {bottom, 0.2})
            for (const auto& [x, z] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
                box += fmt::format("v {} {} {}\n", 0.035 * x, y, 0.035 * z);
        scratch.file("box.obj", box + "f 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n");
        return std::string(head) + "[[solid]]\nname = \"box\"\nattached = \"head\"\nshape = \"mesh\"\n" +
               "file = \"box.obj\"\nunits = \"m\"\nup = \"y\"\n";
    };
    EXPECT_EQ(found(falling(400), "", with_box(0.11)), Names{});
    EXPECT_EQ(found(falling(400), "", with_box(0.05)), Names{"roots_off_head"});
    EXPECT_NE(texts(scene_of(falling(400), "", with_box(0.05)), "roots_off_head").find("hair is pushed out"),
              std::string::npos);
}

TEST_F(Findings, water_that_wets_nothing_is_seen) {
    EXPECT_EQ(found(falling(50), "", std::string(head) + "[wetness]\nlevel = 0\n"), Names{"dry_water"});
}

TEST_F(Findings, sources_of_water_that_come_near_no_strand_are_seen) {
    const std::string wet = std::string(head) + "[wetness]\nlevel = 0\n[wetness.flow]\n";
    EXPECT_EQ(found(falling(50), "", wet), Names{"dry_water"});  // no source at all
    const auto with = [&](const std::string& source) {
        return found(falling(50), "",
                     wet + "[[wetness.source]]\nshape = \"sphere\"\nradius = 0.1\n" + source);
    };
    EXPECT_EQ(with("center = [0, 0.1, 0]\n"), Names{});
    EXPECT_EQ(with("center = [0, 1, 0]\n"), Names{"dry_water"});
    // It comes, and it comes too late: the scene's 100 frames are 4.2 s.
    const std::string falls =
                          "center = [0, 1, 0]\n[[wetness.source.motion.keyframe]]\ntime = 0\n"
                          "[[wetness.source.motion.keyframe]]\ntime = ",
                      down = "\ntranslation = [0, -0.9, 0]\n";
    EXPECT_EQ(with(falls + "2" + down), Names{});
    EXPECT_EQ(with("center = [0, 0.1, 0]\nfrom = 5\n"), Names{"dry_water"});
    EXPECT_EQ(with("center = [0, 0.1, 0]\nrate = 0\n"), Names{"dry_water"});
    // The last of 100 frames is at 99 / 24 s.
    EXPECT_EQ(with("center = [0, 0.1, 0]\nfrom = 4.13\n"), Names{"dry_water"});
    EXPECT_EQ(with("center = [0, 0.1, 0]\nfrom = 4.12\n"), Names{});
    EXPECT_EQ(with("until = 1\n" + falls + "4" + down), Names{"dry_water"});
}

TEST_F(Findings, searches_that_find_far_too_much_are_seen_and_a_radius_is_named) {
    const StrandPoints strands = falling(300);
    const auto wet = [&](const std::string& radius) {
        return scene_of(
            strands, "",
            std::string(head) + "[wetness]\n[cohesion]\nneighbours = 0\nradius = " + radius + "\n");
    };
    const auto wide = [](const Scene& scene) {
        std::vector<Finding> out = findings_of(scene);
        std::erase_if(out, [](const Finding& f) { return f.name != std::string("wide_radius"); });
        return out;
    };
    EXPECT_TRUE(wide(wet("0.016")).empty());
    const auto found = wide(wet("0.8"));
    ASSERT_EQ(found.size(), 1u);
    // 299 other strands of 12 particles.
    EXPECT_NE(found[0].text.find("3588 of other strands"), std::string::npos) << found[0].text;
    // What it names holds the number that it says.
    double radius = 0;
    ASSERT_EQ(std::sscanf(found[0].remedy.c_str(), "radius = %lf", &radius), 1) << found[0].remedy;
    const Strands hair = wet("0.016").groom.rest;
    double near = 0;
    for (int s = 0; s < hair.count; ++s)
        for (int i = 0; i < hair.particles; ++i)
            for (int t = 0; t < hair.count; ++t)
                for (int j = 0; j < hair.particles; ++j)
                    near += s != t && norm(hair.at(s, i) - hair.at(t, j)) < radius;
    EXPECT_NEAR(near / (hair.count * hair.particles), 100, 35);
    // Where some strands stand for all, a frame takes no such time.
    EXPECT_TRUE(
        wide(scene_of(strands, "", std::string(head) + "[wetness]\n[cohesion]\nradius = 0.8\n")).empty());
}

// About pi (range / spacing)^2 of them, on a surface: 314 and 7854.
TEST_F(Findings, a_range_that_holds_thousands_of_boundary_particles_is_seen) {
    const auto with = [&](const std::string& range) {
        return found(falling(50), "",
                     std::string(head) + "[wetness]\n[baseline]\nboundary = \"particles\"\n" +
                         "boundary_range = " + range + "\n");
    };
    EXPECT_EQ(with("0.04"), Names{});
    EXPECT_EQ(with("0.2"), Names{"wide_radius"});
}

TEST_F(Findings, every_name_is_one_that_allow_takes) {
    for (const char* name : Finding::names) {
        above = std::string("allow = [\"") + name + "\"]\n";
        EXPECT_NO_THROW(scene_of(falling(20), "", head, true)) << name;
    }
    above = "allow = [\"everything\"]\n";
    expect_error<Misuse>([&] { scene_of(falling(20)); }, {"allow", "everything", "roots_off_head"});
}

}  // namespace
}  // namespace wetcurl
