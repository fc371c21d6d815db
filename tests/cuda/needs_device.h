// Tests that need a CUDA device: without one each says SKIP and why.
#pragma once

#include <gtest/gtest.h>

#include "cuda/run/simulation.h"

namespace wetcurl::testing {

class NeedsDevice : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string reason;
        if (cuda_devices(&reason).empty()) GTEST_SKIP() << "SKIP: no CUDA device (" << reason << ")";
    }
};

}  // namespace wetcurl::testing
