// What `render --image` shows of files, frame by frame: the root image of runs; inputs, targets and, with
// models, predictions of pairs; the filters of models.
//
// Codec root: colours as they are (Eq 14; of wet runs after Eq 16). Codec strand: of its amplitudes the
// offset of the tip from the root, in the strand's root frame: red x (where the strand lies in the scalp),
// green y (the scalp's normal), blue z; grey is no offset. Residuals are magnified so that all but the
// strongest 2 % keep their colour; captions say by how much.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/drawing/geometry_image.h"

namespace wetcurl {

class GeometryFilm {
  public:
    virtual ~GeometryFilm() = default;
    virtual int frames() const = 0;
    virtual double fps() const { return 24; }
    // Settles how far from grey the strongest colours are, where that is not the codec's to say: what these
    // frames need.
    virtual void settle(int /*first*/, int /*last*/) {}
    // 0 ≤ frame < frames().
    virtual std::vector<GeometryPanel> panels(int frame) = 0;
};

// `files`: runs; a pairs file and any models of its codec; or models. `run`: which of the pairs' runs.
// Throws Error or Misuse where they are something else or do not fit each other.
std::unique_ptr<GeometryFilm> geometry_film(const std::vector<std::string>& files, int run, int threads);

}  // namespace wetcurl
