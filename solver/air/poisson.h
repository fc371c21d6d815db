// Poisson's equation on a box of cubic cells, zero on the box's surface, solved directly: the Laplacian is
// diagonal in products of sines, one matrix an axis. Lynch, Rice and Thomas 1964.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace wetcurl {

// Eigenvectors of -d²/dx² on `n` cells of side `cell` [m], zero at both ends of the row, and its eigenvalues.
struct SineBasis {
    int n;
    std::vector<double> vector;  // (n, n): row k is sin(pi (k + 1) (i + 1/2) / n), normalised
    std::vector<double> value;   // (n) [1/m²]
    SineBasis(int n, double cell);
};

// Solves -lap p = b for cell-centred p and b, of second order in the cell. The same bits on any number of
// threads.
class PoissonBox {
  public:
    // Cells each way, and a cell's side [m].
    PoissonBox(const std::array<int, 3>& cells, double cell);

    // b becomes p; both (nz, ny, nx), nx * ny * nz numbers.
    void solve(std::vector<double>& b);
    const SineBasis& along(int axis) const { return basis_[size_t(axis)]; }
    size_t bytes() const;

  private:
    std::array<SineBasis, 3> basis_;
    std::vector<double> spare_;
};

}  // namespace wetcurl
