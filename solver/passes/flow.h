// The flow of water over a frame: sources, along each strand, between strands in contact, drying. Ours.
// Gathers only; each particle and each strand writes its own slot, so the result is the same for any number
// of threads, and what leaves one particle reaches another to rounding.
#pragma once

#include <vector>

#include "base/geometry/neighbor_list.h"
#include "base/geometry/strands.h"
#include "solver/terms/flow.h"

namespace wetcurl {

// Water of all strands [kg]. What was held at the start and what was taken is now held, dripped or dried.
struct WaterBalance {
    double start = 0, held = 0, taken = 0, dripped = 0, dried = 0;
    double balance() const { return held + dripped + dried - taken - start; }
};

class FlowPass {
  public:
    // `rest`: strands whose segments keep their length [m]; `density`: their dry mass a length [kg/m];
    // `absorbed`: m_absorbed; `saturation` (strand, particle) at the start, in [0, 1].
    FlowPass(const Flow& flow, const Strands& rest, double density, double absorbed,
             const std::vector<float>& saturation);

    // dt [s] from `time` on, strands at p, under `gravity` [m/s²]. `grid` and `list` hold p and every
    // neighbour within `reach`; null: they are searched here.
    void step(const Strands& p, double time, double dt, const Vec3d& gravity, const NeighborGrid* grid,
              const NeighborList* list);

    // Its stages.
    void wet(const Strands& p, double time, double dt);
    void run_along(const Strands& p, double dt, const Vec3d& gravity);
    void exchange(double dt, const NeighborGrid& grid, const NeighborList& list);
    void dry(double dt);

    const std::vector<double>& exact() const { return sigma_; }      // (strand, particle)
    const std::vector<float>& saturation() const { return shown_; }  // the same, as others read it
    const std::vector<double>& dry_mass() const { return mass_; }    // (strand, particle) [kg]
    // Another saturation; the balance begins anew.
    void restore(const std::vector<double>& saturation);
    WaterBalance water() const;
    size_t bytes() const;

  private:
    // Of one strand, in masses of the hair that holds as much.
    struct Ledger {
        double taken = 0, dripped = 0, dried = 0;
    };
    // Of the elimination, (particle): the row's right side, what of it goes on to the next row, what comes
    // back from there, and the pivot.
    struct Rows {
        std::vector<double> right, on, back, pivot;
        explicit Rows(size_t n) : right(n), on(n), back(n), pivot(n) {}
    };
    size_t at(int s, int i) const { return size_t(s) * size_t(n_) + size_t(i); }
    double held() const;
    void run_along_strand(int s, const Vec3f* x, double dt, const Vec3d& down, Rows& rows);
    void shed_excess(int s, double* sigma);
    void search(const Strands& p);
    void show();

    const Flow flow_;
    const int strands_, n_;
    const double density_, absorbed_;
    double start_ = 0;
    std::vector<double> sigma_, next_, mass_, length_, limit_;  // (strand, particle)
    std::vector<float> shown_;
    std::vector<Ledger> ledger_;  // (strand)
    // Where nobody else searches.
    NeighborGrid grid_;
    NeighborList list_;
    std::vector<uint32_t> strand_;
    std::vector<float> any_source_;
};

}  // namespace wetcurl
