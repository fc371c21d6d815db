// What the tests of base share: a folder that goes away, files in it, errors and what they must say, random
// vectors.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <random>
#include <sstream>
#include <string>

#include "base/error.h"
#include "base/vec3.h"

namespace wetcurl::testing {

// A folder of this test's own, removed with all that is in it.
class Scratch {
  public:
    Scratch() {
        std::string name = (std::filesystem::temp_directory_path() / "wetcurl_test_XXXXXX").string();
        if (!mkdtemp(name.data())) throw Error("no folder for tests can be made at " + name);
        folder_ = name;
    }
    ~Scratch() { std::filesystem::remove_all(folder_); }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    std::string path(const std::string& name = "") const {
        return name.empty() ? folder_ : folder_ + "/" + name;
    }
    // Writes `bytes` and returns the path.
    std::string file(const std::string& name, const std::string& bytes) const {
        std::ofstream(path(name), std::ios::binary) << bytes;
        return path(name);
    }

  private:
    std::string folder_;
};

inline std::string bytes_of(const std::string& path) {
    std::stringstream all;
    all << std::ifstream(path, std::ios::binary).rdbuf();
    return all.str();
}

// `act` must throw E, and its text must hold each of `parts`.
template <class E = Error, class Act>
void expect_error(Act act, std::initializer_list<std::string> parts) {
    try {
        act();
    } catch (const E& e) {
        for (const auto& part : parts)
            EXPECT_NE(std::string(e.what()).find(part), std::string::npos)
                << "'" << part << "' is not in: " << e.what();
        return;
    } catch (const std::exception& e) {
        ADD_FAILURE() << "an error of another kind: " << e.what();
        return;
    }
    ADD_FAILURE() << "no error";
}

class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double number(double low = -1, double high = 1) {
        return std::uniform_real_distribution<double>(low, high)(engine_);
    }
    Vec3d vector(double size = 1) { return {number(-size, size), number(-size, size), number(-size, size)}; }
    Vec3d direction() {
        for (;;)
            if (const Vec3d v = vector(); norm(v) > 0.1 && norm(v) < 1) return (1 / norm(v)) * v;
    }
    Quatd rotation() { return rotation_about(direction(), number(0, 6)); }

  private:
    std::mt19937 engine_;
};

}  // namespace wetcurl::testing
