// A program built without OpenCV: its pictures link, and say what is missing. image_file.cpp is compiled for
// this once more, without WETCURL_HAVE_OPENCV.
#include <gtest/gtest.h>

#include "app/drawing/image_file.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

TEST(WithoutOpenCV, pictures_are_refused_with_what_to_install) {
    Image image(4, 3);
    const auto refused = [](auto&& call) {
        testing::expect_error(call, {"without OpenCV", "libopencv-dev"});
    };
    refused([&] { write_png("image.png", image, false); });
    refused([&] { draw_text(image, "text", 1, 1, 1, 0.5); });
    refused([&] { text_width("text", 1); });
    refused([&] { draw_label(image, "label"); });
    refused([&] { draw_rainbow_legend(image, "1", "saturation"); });
    refused([&] { VideoFile("video.mp4", 4, 3, 24, false); });
}

}  // namespace
}  // namespace wetcurl
