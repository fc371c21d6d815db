// A small shot that tests write to files of other programs: strands of different lengths, which swing and are
// partly wet, and a mesh that moves.
#pragma once

#include <cmath>

#include "base/exchange/scene_file.h"

namespace wetcurl::testing {

struct Shot {
    static constexpr int frames = 5;
    SceneFileSettings settings;
    CurvesObject strands;
    MeshObject mesh;

    Shot() {
        settings.fps = 25;
        settings.first_frame = 3;
        settings.metres_per_unit = 0.01;
        strands.path = "/hair/strands";
        constexpr int count = 30;
        for (int s = 0; s < count; ++s) {
            strands.counts.push_back(2 + s % 7);
            strands.ids.push_back(100 + s);
            strands.groups.push_back(s % 3);
            strands.root_uv.push_back({float(s) / count, 0.25f});
            strands.is_guide.push_back(s % 5 == 0);
            strands.guides.push_back({s / 5 * 5, 5, 10});
            strands.weights.push_back({0.5f, 0.25f, 0.25f});
            for (int i = 0; i < strands.counts.back(); ++i) strands.widths.push_back(0.01f / float(i + 1));
        }
        mesh.path = "/body/head";
        mesh.counts = {3, 3, 3, 3, 4};
        mesh.corners = {1, 0, 4, 2, 1, 4, 3, 2, 4, 0, 3, 4, 0, 1, 2, 3};  // a pyramid
        mesh.points = 5;
    }

    // x(t) = root + swing sin(t), and its derivative.
    CurvesFrame curves(int frame) const {
        CurvesFrame out;
        const double t = (settings.first_frame + frame) / settings.fps;
        for (size_t s = 0; s < strands.counts.size(); ++s)
            for (int i = 0; i < strands.counts[s]; ++i) {
                const double swing = 0.3 * i;
                out.points.push_back(
                    {float(0.1 * double(s) + swing * std::sin(3 * t)), float(-0.5 * i), float(swing * t)});
                out.velocities.push_back({float(3 * swing * std::cos(3 * t)), 0, float(swing)});
                out.wetness.push_back(float(i) / 8 + float(frame) / 16);
            }
        return out;
    }
    std::vector<Vec3f> mesh_points(int frame) const {
        const float lift = 0.125f * float(frame);
        return {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}, {0, 1 + lift, 0}};
    }

    // Writes all frames; of the mesh too, where `with_mesh`.
    void write(SceneWriter& file, bool with_mesh = true) const {
        const size_t curves_number = file.add_curves(strands);
        const size_t mesh_number = with_mesh ? file.add_mesh(mesh) : 0;
        for (int f = 0; f < frames; ++f) {
            file.append_curves(curves_number, curves(f));
            if (with_mesh) file.append_mesh(mesh_number, mesh_points(f));
        }
        file.finish();
    }
};

}  // namespace wetcurl::testing
