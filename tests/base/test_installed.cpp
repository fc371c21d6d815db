// Files of the installation are found from any folder; the user's own go first.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "base/installed.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

namespace fs = std::filesystem;

TEST(Installed, is_found_where_no_own_file_has_the_name) {
    // A folder that no other test has: this program's own plays the part of PREFIX/bin.
    const std::string scenes = "scenes_of_" + std::to_string(getpid());
    const fs::path there = own_folder().parent_path() / "share/wetcurl" / scenes;
    ASSERT_TRUE(fs::exists(own_folder() / "test_base"));
    fs::create_directories(there);
    std::ofstream(there / "a.toml") << "title = \"installed\"\n";
    EXPECT_EQ(found_or_installed(scenes + "/a.toml"), (there / "a.toml").string());
    EXPECT_EQ(found_or_installed(scenes + "/b.toml"), scenes + "/b.toml");
    EXPECT_EQ(found_or_installed("/" + scenes + "/a.toml"), "/" + scenes + "/a.toml");

    const testing::Scratch folder;
    const fs::path before = fs::current_path();
    fs::current_path(folder.path("."));
    fs::create_directories(scenes);
    std::ofstream(scenes + "/a.toml") << "title = \"mine\"\n";
    EXPECT_EQ(found_or_installed(scenes + "/a.toml"), scenes + "/a.toml");
    fs::current_path(before);
    fs::remove_all(there);
}

}  // namespace
}  // namespace wetcurl
