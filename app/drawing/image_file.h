// Images to files: PNG, video, text and the legend drawn into an image. OpenCV stands behind it, in one
// translation unit; without it (WETCURL_HAVE_OPENCV not defined) every function throws Error and says so.
#pragma once

#include <memory>
#include <string>

#include "app/drawing/picture.h"

namespace wetcurl {

// Writes an 8-bit PNG, as an OutputFile. Throws Error where it cannot.
void write_png(const std::string& path, const Image& image, bool overwrite);

// Text whose baseline lies at `row`, `height` [pixel] from line to line; of its width the part `anchor` lies
// left of `column`. Shifted to where it fits.
void draw_text(Image& image, const std::string& text, int column, int row, double height, double anchor);

// How wide draw_text draws it [pixel].
int text_width(const std::string& text, double height);

// Text centred under the picture, on the last rows of the image.
void draw_label(Image& image, const std::string& text);

// A bar in the colours of `rainbow_color`, at the right edge of the image: its end, and what it shows.
void draw_rainbow_legend(Image& image, const std::string& end, const std::string& shows);

// Frames of one size to one file. What was really written may differ from what was asked for: `avc1` in
// .mp4, else `VP80` in .webm beside it, else a folder of PNGs; each step down is said in the log.
class VideoFile {
  public:
    VideoFile(const std::string& path, int width, int height, double fps, bool overwrite);
    ~VideoFile();
    void append(const Image& image);
    // Closes the file, gives it its name and returns that name.
    std::string commit();
    // Closes a file that is not whole under the name that it has meanwhile, NAME.partial.mp4; returns that.
    std::string leave();

  private:
    struct Body;
    std::unique_ptr<Body> body_;
};

}  // namespace wetcurl
