// Writers of strand files: one frame of strands for other programs, Y up.
#pragma once

#include <string>

#include "base/output_file.h"
#include "solver/grooms/readers.h"

namespace wetcurl {

// Of a hair [m], where nothing else is said.
inline constexpr float usual_width = 8e-5f;

// Bytes to a file, many at a time.
class ByteWriter {
  public:
    explicit ByteWriter(OutputFile& file) : file_(file) {}
    template <class T>
    void put(const T& value) {
        waiting_.append(reinterpret_cast<const char*>(&value), sizeof value);
        flush(size_t(1) << 20);
    }
    void text(const std::string& more) {
        waiting_ += more;
        flush(size_t(1) << 20);
    }
    void flush(size_t above = 0) {
        if (waiting_.size() <= above) return;
        file_.write(waiting_);
        waiting_.clear();
    }

  private:
    OutputFile& file_;
    std::string waiting_;
};

// What a writer writes. `widths` are empty or one a point.
struct StrandsOut {
    std::string path;  // for messages
    const StrandPoints& strands;
    const StrandWidths& widths;
    std::string unit;  // of both, as a file says it that can
    float width(size_t strand, size_t point) const {
        return widths.empty() ? usual_width : widths[strand][point];
    }
};

void write_hair(ByteWriter& out, const StrandsOut& in);  // Cem Yuksel: widths as thickness
void write_data(ByteWriter& out, const StrandsOut& in);  // USC-HairSalon
void write_ply(ByteWriter& out, const StrandsOut& in);   // vertices with width, and edges
void write_obj(ByteWriter& out, const StrandsOut& in);   // `v` and `l` lines
// TressFX 4. Strands are resampled to a power of two, 4 to 64 points, unless all have such a number; the log
// says so. Thickness: the largest of the strand.
void write_tfx(ByteWriter& out, const StrandsOut& in);
// PBRT 4: a shape "curve" for each strand, cubic Bezier pieces through its points, to be included in a scene.
void write_pbrt(ByteWriter& out, const StrandsOut& in);

}  // namespace wetcurl
