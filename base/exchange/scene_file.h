// What files of other programs hold of a shot, as this program hands it over and takes it: animated strands
// and meshes. Alembic (alembic.h) and USD text (usda.h) are read and written behind these two interfaces.
//
// Everything stands in the file's own unit and axes; transforms above an object are applied to its points.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/vec3.h"

namespace wetcurl {

enum class CurveBasis { linear, bezier, b_spline, catmull_rom };

// How a file says its numbers are meant; empty where it does not.
struct FileAxes {
    std::optional<double> metres_per_unit = {};
    std::optional<char> up = {};       // 'x', 'y', 'z'
    std::optional<double> rate = {};   // frames a second, in which it counts
    std::optional<double> start = {};  // [s] of its clock, where its shot begins
};

// Strands, or one object of them, without their points: what is the same at all times.
struct CurvesObject {
    std::string path;                           // in the file: "/hair/strands"
    std::string hidden;                         // as MeshObject's
    std::vector<int> counts;                    // (strand): control points, root first
    CurveBasis basis = CurveBasis::linear;      // of all strands
    std::vector<float> widths;                  // (point): diameter; empty: not said
    std::vector<int> ids, groups;               // (strand); empty: not said
    std::vector<std::array<float, 2>> root_uv;  // (strand); empty: not said
    std::vector<uint8_t> is_guide;              // (strand); empty: not said
    std::vector<std::array<int, 3>> guides;     // (strand): its nearest guides, as numbers of strands
    std::vector<std::array<float, 3>> weights;  // (strand): of these guides
    std::vector<double> times;                  // (sample) [s]; one where it does not move
    size_t points() const {
        size_t sum = 0;
        for (int count : counts) sum += size_t(count);
        return sum;
    }
};

// A mesh without its points.
struct MeshObject {
    std::string path;
    std::string hidden;        // how the file hides it: "invisible", "for guide"; empty: it is shown
    std::vector<int> counts;   // (face): its corners
    std::vector<int> corners;  // indices of points, counterclockwise seen from outside
    size_t points = 0;
    std::vector<double> times;  // (sample) [s]; one where it does not move
};

class SceneReader {
  public:
    virtual ~SceneReader() = default;
    virtual const FileAxes& axes() const = 0;
    virtual const std::vector<CurvesObject>& curves() const = 0;
    virtual const std::vector<MeshObject>& meshes() const = 0;
    // Points of an object at one of its samples. Throw Error (file, object, sample) for what the file lacks,
    // for a count other than the first sample's, and for numbers that are not finite.
    virtual std::vector<Vec3f> points_of_curves(size_t object, size_t sample) const = 0;
    virtual std::vector<Vec3f> points_of_mesh(size_t object, size_t sample) const = 0;
};

// Whether the ending is one of Alembic or USD.
bool is_scene_file(const std::string& path);

// Numbers of the objects that are meant: `object` itself, those below it, or all for "". Of them those that
// the file shows; all where it shows none. What is left out, or taken though it is hidden, is told in the
// log. Empty where no object is there. `what` names them in messages: "meshes".
template <class Object>
std::vector<size_t> chosen_objects(const std::string& path, const std::vector<Object>& objects,
                                   const std::string& object, const std::string& what);

// By the file's ending, .abc or .usda. Throws Misuse for another ending, Error for a file that is missing,
// cut short, foreign, or of a kind that is not read (HDF5 Alembic, .usd and .usdc: the text says what to
// run).
std::unique_ptr<SceneReader> open_scene_file(const std::string& path);

// One frame of an object.
struct CurvesFrame {
    std::vector<Vec3f> points;
    std::vector<Vec3f> velocities;  // (point), a second; empty: not written
    std::vector<float> wetness;     // (point); empty: not written
};

// Who the file is for: what is the same in all its objects.
struct SceneFileSettings {
    double fps = 24;
    int first_frame = 1;         // number of the first frame; the time of a frame is its number / fps
    int every = 1;               // from one frame's number to the next one's
    double metres_per_unit = 1;  // of the points as they are given; said where the format can say it
    char up = 'y';
    // The points' y and z have changed places, for a program that counts them so: said where the format can
    // say it, and taken back by our reader.
    bool swaps_y_and_z = false;
    bool for_unreal = false;  // the attributes that Unreal's groom importer asks for
};

// Objects are added before the first frame; then each frame gives every object its points, in the order in
// which they were added; then `finish`. Memory does not grow with frames.
class SceneWriter {
  public:
    virtual ~SceneWriter() = default;
    // Return the number of the object. `times` and, of a mesh, nothing else is ignored: settings say the
    // times.
    virtual size_t add_curves(const CurvesObject& object) = 0;
    virtual size_t add_mesh(const MeshObject& object) = 0;
    virtual void append_curves(size_t object, const CurvesFrame& frame) = 0;
    virtual void append_mesh(size_t object, const std::vector<Vec3f>& points) = 0;
    // The file has its name after this, and not before. Throws Error where it cannot be written.
    virtual void finish() = 0;
};

// By the file's ending. Throws Misuse and Error as OutputFile does.
std::unique_ptr<SceneWriter> create_scene_file(const std::string& path, bool overwrite,
                                               const SceneFileSettings& settings);

}  // namespace wetcurl
