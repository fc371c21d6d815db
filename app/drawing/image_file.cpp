// OpenCV's part of the pictures: files and text.
#include "app/drawing/image_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "base/error.h"
#include "base/log.h"
#include "base/output_file.h"

#ifdef WETCURL_HAVE_OPENCV
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#endif

namespace wetcurl {

namespace fs = std::filesystem;

#ifdef WETCURL_HAVE_OPENCV

namespace {

// 8 bits, blue green red, as OpenCV keeps pictures; not a number is black.
cv::Mat bytes_of(const Image& image) {
    cv::Mat result(image.height, image.width, CV_8UC3);
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column)
            for (int c = 0; c < 3; ++c) {
                const float x = image.pixel(column, row)[c];
                result.at<cv::Vec3b>(row, column)[2 - c] =
                    std::isfinite(x) ? uint8_t(std::lround(255 * std::clamp(x, 0.f, 1.f))) : uint8_t(0);
            }
    return result;
}

}  // namespace

void write_png(const std::string& path, const Image& image, bool overwrite) {
    std::vector<uint8_t> file;
    if (image.width < 1 || image.height < 1 || !cv::imencode(".png", bytes_of(image), file))
        throw Error(path + ": a picture of " + std::to_string(image.width) + " x " +
                    std::to_string(image.height) + " pixels cannot be written as PNG");
    OutputFile out(path, overwrite);
    out.write({file.begin(), file.end()});
    out.commit();
}

// Drawn large and shrunk: the strokes of OpenCV's letters are whole pixels wide.
void draw_text(Image& image, const std::string& text, int column, int row, double height, double anchor) {
    constexpr int large = 4;
    const double scale = large * height / 22;
    const int thickness = std::max(1, int(std::lround(1.6 * scale)));
    int below = 0;
    const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_DUPLEX, scale, thickness, &below);
    const int margin = large * 4;
    const int width = (size.width + 2 * margin) / large, rows = (size.height + below + 2 * margin) / large;
    cv::Mat mask(rows * large, width * large, CV_8U, cv::Scalar(0)), small;
    cv::putText(mask, text, {margin, margin + size.height}, cv::FONT_HERSHEY_DUPLEX, scale, cv::Scalar(255),
                thickness, cv::LINE_AA);
    cv::resize(mask, small, {width, rows}, 0, 0, cv::INTER_AREA);
    const int left =
                  std::clamp(column - int(std::lround(anchor * width)), 0, std::max(0, image.width - width)),
              top = row - (margin + size.height) / large;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < width; ++c) {
            if (left + c < 0 || left + c >= image.width || top + r < 0 || top + r >= image.height) continue;
            const float ink = small.at<uint8_t>(r, c) / 255.f;
            float* p = image.pixel(left + c, top + r);
            for (int k = 0; k < 3; ++k) p[k] += ink * (0.13f - p[k]);
        }
}

int text_width(const std::string& text, double height) {
    int below = 0;
    return 8 + cv::getTextSize(text, cv::FONT_HERSHEY_DUPLEX, height / 22, 1, &below).width;
}

void draw_label(Image& image, const std::string& text) {
    double height = 0.021 * image.height;
    int below = 0;
    auto width = [&] { return cv::getTextSize(text, cv::FONT_HERSHEY_DUPLEX, height / 22, 1, &below).width; };
    while (height > 6 && width() > 0.94 * image.width) height *= 0.95;
    draw_text(image, text, image.width / 2, int(0.972 * image.height), height, 0.5);
}

void draw_rainbow_legend(Image& image, const std::string& end, const std::string& shows) {
    const int top = int(0.10 * image.height), bottom = int(0.38 * image.height);
    const int right = int(0.965 * image.width), left = right - std::max(6, image.width / 50);
    for (int r = top; r < bottom; ++r) {
        const Vec3f color = rainbow_color(1 - (r - top + 0.5f) / (bottom - top));
        for (int c = left; c < right; ++c) {
            float* p = image.pixel(c, r);
            p[0] = color.x, p[1] = color.y, p[2] = color.z;
        }
    }
    const double height = 0.016 * image.height;
    const int middle = (left + right) / 2;
    draw_text(image, end, middle, top - int(0.4 * height), height, 0.5);
    draw_text(image, "0", middle, bottom + int(1.3 * height), height, 0.5);
    draw_text(image, shows, middle, bottom + int(2.8 * height), height, 0.5);
}

struct VideoFile::Body {
    std::optional<OutputFile> file;
    // Where no codec was found, a folder of PNGs.
    std::string folder;
    std::optional<OutputFolder> filled;
    bool overwrite = false;
    cv::VideoWriter writer;
    cv::Size size;
    int written = 0;

    bool open(const std::string& path, const char (&codec)[5], double fps) {
        file.emplace(path, overwrite, fs::path(path).extension().string());
        file->begin();
        const int code = cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]);
        try {
            if (writer.open(file->partial(), cv::CAP_FFMPEG, code, fps, size)) return true;
        } catch (const cv::Exception&) {
        }
        file.reset();
        return false;
    }
};

VideoFile::VideoFile(const std::string& path, int width, int height, double fps, bool overwrite)
    : body_(new Body) {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    Body& b = *body_;
    b.size = {width & ~1, height & ~1};  // both codecs halve the colours each way
    b.overwrite = overwrite;
    const bool mp4 = fs::path(path).extension() == ".mp4";
    const std::string webm = fs::path(path).replace_extension(".webm").string();
    if (mp4 && b.open(path, "avc1", fps)) return;
    if (b.open(webm, "VP80", fps)) {
        if (mp4)
            log_warning(path + ": this OpenCV has no H.264 encoder; writing VP8 to " + webm + " instead");
        return;
    }
    b.folder = fs::path(path).replace_extension().string() + "_frames";
    b.filled.emplace(b.folder);
    log_warning(path + ": this OpenCV has neither an H.264 nor a VP8 encoder for " +
                std::to_string(b.size.width) + " x " + std::to_string(b.size.height) +
                " pixels; writing PNGs to " + b.folder + "/ instead");
}

VideoFile::~VideoFile() = default;

void VideoFile::append(const Image& image) {
    Body& b = *body_;
    if (b.file) {
        b.writer.write(bytes_of(image)(cv::Rect(cv::Point(0, 0), b.size)));
        b.file->keep();  // what is in it can be played
    } else {
        std::string number = std::to_string(b.written);
        write_png(b.folder + "/" + std::string(5 - std::min<size_t>(5, number.size()), '0') + number + ".png",
                  image, b.overwrite);
    }
    ++b.written;
}

std::string VideoFile::leave() {
    Body& b = *body_;
    if (!b.file) return b.folder;
    b.writer.release();
    return b.file->partial();
}

std::string VideoFile::commit() {
    Body& b = *body_;
    if (!b.file) return b.folder;
    b.writer.release();
    b.file->commit();
    return b.file->path();
}

#else

namespace {
[[noreturn]] void no_opencv() {
    throw Error(
        "this wetcurl was built without OpenCV, which writes pictures and videos: install libopencv-dev and "
        "build again");
}
}  // namespace

struct VideoFile::Body {};
VideoFile::VideoFile(const std::string&, int, int, double, bool) { no_opencv(); }
VideoFile::~VideoFile() = default;
void VideoFile::append(const Image&) { no_opencv(); }
std::string VideoFile::leave() { no_opencv(); }
std::string VideoFile::commit() { no_opencv(); }
void write_png(const std::string&, const Image&, bool) { no_opencv(); }
void draw_text(Image&, const std::string&, int, int, double, double) { no_opencv(); }
int text_width(const std::string&, double) { no_opencv(); }
void draw_label(Image&, const std::string&) { no_opencv(); }
void draw_rainbow_legend(Image&, const std::string&, const std::string&) { no_opencv(); }

#endif

}  // namespace wetcurl
