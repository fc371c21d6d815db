// What `inspect scene` says that settings cost and gain: what was measured, where it was, and between.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/measures/settings_advice.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

SettingsAdvice advice_of(const std::string& text) {
    const Scene scene = parse_scene("[groom]\ngrid = [4, 4]\nparticles = 200\n" + text, "scene", ".");
    const auto advice = advice_on(scene);
    EXPECT_TRUE(advice) << text;
    return advice.value_or(SettingsAdvice{});
}
double error_of(const SettingsAdvice& advice, const std::string& setting) {
    for (const auto& row : advice.rows)
        if (row.setting == setting) return row.error;
    ADD_FAILURE() << setting;
    return NAN;
}
double time_of(const SettingsAdvice& advice, const std::string& setting) {
    for (const auto& row : advice.rows)
        if (row.setting == setting) return row.time;
    ADD_FAILURE() << setting;
    return NAN;
}

const std::string wet = "[wetness]\n[curl]\n[cohesion]\n";

std::string text_of(const std::string& hair, const std::string& kind) {
    return (hair == "springs" ? "[stretch]\n[bend]\n" : "[fibre]\nhair = \"" + hair + "\"\n") +
           (kind == "dry" ? "" : wet) + (kind == "touching" ? "[strand_contact]\n" : "");
}

TEST(SettingsAdvice, is_what_was_measured_of_such_hair) {
    std::ifstream file(WETCURL_SOURCE_DIR "/results/settings/cpu.json");
    const auto table = nlohmann::json::parse(file);
    ASSERT_EQ(table.at("hair").size(), 15u);
    for (const auto& hair : table.at("hair")) {
        const std::string name = hair.at("hair"), kind = hair.at("kind");
        const SettingsAdvice advice = advice_of("[integrator]\nsubsteps = 10\n" + text_of(name, kind));
        EXPECT_EQ(advice.hair, name);
        EXPECT_EQ(advice.kind, kind);
        EXPECT_EQ(advice.machine, table.at("provenance").at("processor"));
        EXPECT_EQ(advice.rows.at(0).time, 1);
        double usual = NAN;
        for (const auto& row : hair.at("rows"))
            if (row.at("substeps") == 10 && row.at("precision") == "float" && !row.contains("cohesion"))
                usual = row.at("frame_seconds");
        size_t seen = 0;
        for (const auto& row : hair.at("rows")) {
            const double error = row.at("median_percent"), time = double(row.at("frame_seconds")) / usual;
            std::string setting;
            if (row.contains("cohesion"))
                for (const auto& [key, value] : row.at("cohesion").items())
                    setting = "cohesion." + key + " = " + std::to_string(value.get<int>());
            else if (row.at("precision") == "double")
                setting = row.at("substeps") == 10 ? "--precision double" : "";
            else if (row.at("substeps") == 10)
                setting = "as it is";
            else if (row.at("substeps") != 40)
                setting = "integrator.substeps = " + std::to_string(row.at("substeps").get<int>());
            if (setting.empty() || setting.find("neighbours") != std::string::npos) continue;
            ++seen;
            EXPECT_NEAR(error_of(advice, setting), error, 1e-9 + 1e-9 * error)
                << name << " " << kind << " " << setting;
            EXPECT_NEAR(time_of(advice, setting), time, 1e-9 * time) << name << " " << kind << " " << setting;
        }
        EXPECT_EQ(seen, kind == "wet" ? 6u : 4u);
        EXPECT_EQ(advice.rows.size(), seen);
    }
}

TEST(SettingsAdvice, lies_between_what_was_measured_and_is_careful_beyond) {
    double before = INFINITY;
    for (const int substeps : {1, 3, 5, 7, 10, 15, 20, 30, 40, 60, 1000}) {
        const SettingsAdvice advice = advice_of("[integrator]\nsubsteps = " + std::to_string(substeps) +
                                                "\n" + text_of("springs", "dry"));
        const double error = advice.rows.at(0).error;
        if (substeps <= 5 || substeps > 40)
            EXPECT_NEAR(error, std::isinf(before) ? error : before, 1e-12) << substeps;
        else
            EXPECT_LT(error, before) << substeps;
        before = error;
        const std::string doubled = "integrator.substeps = " + std::to_string(2 * substeps);
        const bool has_doubled = std::any_of(advice.rows.begin(), advice.rows.end(),
                                             [&](const auto& row) { return row.setting == doubled; });
        EXPECT_EQ(has_doubled, substeps >= 3 && substeps <= 20) << substeps;
        if (!has_doubled) continue;
        EXPECT_LT(error_of(advice, doubled), error) << substeps;
        EXPECT_GT(time_of(advice, doubled), 1) << substeps;
    }
}

TEST(SettingsAdvice, tells_what_a_scene_would_save_that_computes_all_of_Eq_10) {
    const std::string hair = "[stretch]\n[bend]\n[wetness]\n[cohesion]\n";
    const SettingsAdvice usual = advice_of(hair),
                         printed = advice_of(hair + "relaxation = 1\nspacing = 0\nneighbours = 0\n");
    EXPECT_GT(time_of(usual, "cohesion.spacing = 0"), 1.2);
    EXPECT_NEAR(time_of(printed, "without cohesion.spacing = 0"), 1 / time_of(usual, "cohesion.spacing = 0"),
                1e-9);
    const double difference = error_of(usual, "cohesion.relaxation = 1") - error_of(usual, "as it is");
    EXPECT_NEAR(error_of(printed, "as it is") - error_of(printed, "without cohesion.relaxation = 1"),
                difference, 1e-9);
    const auto& advice = printed.advice;
    EXPECT_TRUE(std::any_of(advice.begin(), advice.end(), [](const std::string& text) {
        return text.find("without cohesion.spacing = 0: errs by") == 0;
    }));
}

TEST(SettingsAdvice, knows_curls_by_their_curvature) {
    const auto measured_for = [](const std::string& hair) { return advice_of(text_of(hair, "dry")).hair; };
    EXPECT_EQ(measured_for("horse"), "type1");
    EXPECT_EQ(measured_for("type3c"), "type3b");
    EXPECT_EQ(measured_for("type4c"), "type4a");
}

TEST(SettingsAdvice, is_none_on_what_was_not_measured) {
    const auto advice = [](const std::string& text) {
        return advice_on(
            parse_scene("[groom]\ngrid = [4, 4]\n[stretch]\n[bend]\n[core]\n" + text, "scene", "."));
    };
    EXPECT_TRUE(advice(""));
    EXPECT_FALSE(advice("[integrator]\nkind = \"explicit\"\n"));
    EXPECT_FALSE(advice("[strand_contact]\n"));
    EXPECT_FALSE(advice("[wetness]\n"));
    EXPECT_FALSE(advice("[wetness]\n[cohesion]\nstrength = 5\n"));
    EXPECT_FALSE(advice("[wetness]\n[baseline]\nmethod = \"lin\"\n"));
}

}  // namespace
}  // namespace wetcurl
