// Every file says what made it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <regex>
#include <string>

#include "base/hdf5.h"
#include "base/provenance.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

std::string fact(const std::string& name) {
    for (const auto& [key, text] : provenance())
        if (key == name) return text;
    return "";
}

TEST(Provenance, names_revision_build_and_machine) {
    EXPECT_TRUE(std::regex_match(fact("version"), std::regex("\\d+\\.\\d+\\.\\d+"))) << fact("version");
    EXPECT_TRUE(std::regex_match(fact("revision"), std::regex("[0-9a-f]{12}(, changed)?|unknown|v.*")))
        << fact("revision");
    for (const char* name : {"preset", "compiler", "instruction_set", "processor", "gpu"})
        EXPECT_FALSE(fact(name).empty()) << name;
}

TEST(Provenance, takes_the_date_of_a_reproducible_build) {
    setenv("SOURCE_DATE_EPOCH", "86400", 1);
    EXPECT_EQ(fact("date"), "1970-01-02");
    unsetenv("SOURCE_DATE_EPOCH");
    EXPECT_TRUE(std::regex_match(fact("date"), std::regex("20\\d\\d-\\d\\d-\\d\\d"))) << fact("date");
    EXPECT_NE(fact("date"), "1970-01-02");
}

TEST(Provenance, stands_in_every_hdf5_file) {
    const testing::Scratch folder;
    const std::string path = folder.path("a.h5");
    H5Writer(path, "a test", 1, false).commit();
    const H5Reader file(path, "a test", 1);
    for (const auto& [name, text] : provenance()) EXPECT_EQ(file.text("provenance." + name), text);
}

TEST(Provenance, names_the_gpu_in_use) {
    const std::string before = fact("gpu");
    EXPECT_EQ(before, "none");
    note_gpu("A GPU");
    EXPECT_EQ(fact("gpu"), "A GPU");
    note_gpu(before);
}

}  // namespace
}  // namespace wetcurl
