// Poisson's equation on a box of cubic cells, zero on the box's surface: geometric multigrid, V-cycles of
// red-black Gauss-Seidel. Trottenberg 2001, Sec. 2; the cells' boundary rows are ours.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace wetcurl {

// Solves -lap p = b for cell-centred p and b, of second order in the cell. The same bits on any number of
// threads.
class Multigrid {
  public:
    // Cells each way, and a cell's side [m]. Grids halve while their sides are even.
    Multigrid(const std::array<int, 3>& cells, double cell);

    double& p(int i, int j, int k) { return levels_[0].p[levels_[0].at(i, j, k)]; }
    double& b(int i, int j, int k) { return levels_[0].b[levels_[0].at(i, j, k)]; }
    double p(int i, int j, int k) const { return levels_[0].p[levels_[0].at(i, j, k)]; }

    void v_cycle() { v_cycle(0); }
    double residual() const;  // max |b + lap p|
    double right_side() const;
    // Cycles from the present p until the residual is at most `tolerance` of b; returns how many.
    int solve(double tolerance, int most_cycles);
    size_t bytes() const;

  private:
    // With a layer of zeros around, so that a sum over neighbours needs no question.
    struct Level {
        int nx, ny, nz;
        double h2;  // cell^2
        std::vector<double> p, b;
        size_t at(int i, int j, int k) const {
            return (size_t(k + 1) * size_t(ny + 2) + size_t(j + 1)) * size_t(nx + 2) + size_t(i + 1);
        }
        // Faces of a row of cells on the box's surface, without those at its ends.
        int surfaces(int j, int k) const { return (j == 0) + (j == ny - 1) + (k == 0) + (k == nz - 1); }
        double residual(int i, int j, int k) const;
    };
    static void smooth(Level& l, double omega, int sweeps);
    static void restrict_residual(const Level& fine, Level& coarse);
    static void add_correction(const Level& coarse, Level& fine);
    void v_cycle(size_t level);
    std::vector<Level> levels_;
};

}  // namespace wetcurl
