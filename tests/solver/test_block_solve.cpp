// The banded block solve against dense Eigen, on plain numbers and on packs whose lanes are different
// systems. Golub and Van Loan, 4.3.
#include "tests/solver/one_strand.h"

namespace wetcurl {
namespace {

using namespace testing;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int blocks = 17;

// L L^T of a random banded block-triangular L: symmetric, positive, of the same band.
MatrixXd banded_matrix(int band, unsigned seed) {
    Random random(seed);
    MatrixXd l = MatrixXd::Zero(3 * blocks, 3 * blocks);
    for (int i = 0; i < blocks; ++i)
        for (int j = std::max(0, i - band); j <= i; ++j)
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b)
                    l(3 * i + a, 3 * j + b) = random.number() + (i == j && a == b ? 4 : 0);
    return l * l.transpose();
}
VectorXd random_vector(unsigned seed) {
    Random random(seed);
    VectorXd out(3 * blocks);
    for (auto& v : out) v = random.number();
    return out;
}

template <class S>
constexpr int lanes_in = 1;
template <class T>
constexpr int lanes_in<Pack<T>> = Pack<T>::lanes;
template <class S>
void put(S& to, int, double v) {
    to = S(v);
}
template <class T>
void put(Pack<T>& to, int lane, double v) {
    to.set(lane, T(v));
}
template <class S>
double taken(const S& from, int) {
    return from;
}
template <class T>
double taken(const Pack<T>& from, int lane) {
    return double(from[lane]);
}

template <class S>
void put(Vec3<S>& to, int lane, const Eigen::Vector3d& v) {
    put(to.x, lane, v[0]), put(to.y, lane, v[1]), put(to.z, lane, v[2]);
}
template <class S>
void put(Mat3<S>& to, int lane, const Eigen::Matrix3d& m) {
    put(to.r0, lane, Eigen::Vector3d(m.row(0)));
    put(to.r1, lane, Eigen::Vector3d(m.row(1)));
    put(to.r2, lane, Eigen::Vector3d(m.row(2)));
}

// The largest error of the solution over the solution's size, in any lane, of rows `first` and on.
template <bool Penta, class S>
double solve_error(int first) {
    std::vector<Sym3<S>> diagonal(blocks);
    std::vector<Mat3<S>> upper1(blocks), upper2(blocks);
    std::vector<Vec3<S>> r(blocks);
    std::vector<VectorXd> wanted;
    for (int lane = 0; lane < lanes_in<S>; ++lane) {
        const MatrixXd a = banded_matrix(Penta ? 2 : 1, unsigned(50 + lane));
        const VectorXd b = random_vector(unsigned(90 + lane));
        for (int i = 0; i < blocks; ++i) {
            const Eigen::Matrix3d m = a.block<3, 3>(3 * i, 3 * i);
            put(diagonal[size_t(i)].xx, lane, m(0, 0)), put(diagonal[size_t(i)].xy, lane, m(0, 1));
            put(diagonal[size_t(i)].xz, lane, m(0, 2)), put(diagonal[size_t(i)].yy, lane, m(1, 1));
            put(diagonal[size_t(i)].yz, lane, m(1, 2)), put(diagonal[size_t(i)].zz, lane, m(2, 2));
            if (i + 1 < blocks)
                put(upper1[size_t(i)], lane, Eigen::Matrix3d(a.block<3, 3>(3 * i, 3 * i + 3)));
            if (i + 2 < blocks)
                put(upper2[size_t(i)], lane, Eigen::Matrix3d(a.block<3, 3>(3 * i, 3 * i + 6)));
            put(r[size_t(i)], lane, Eigen::Vector3d(b.segment<3>(3 * i)));
        }
        const long rows = 3 * (blocks - first);
        wanted.push_back(a.bottomRightCorner(rows, rows).ldlt().solve(b.tail(rows)));
    }
    solve_blocks<Penta>(first, blocks, diagonal.data(), upper1.data(), upper2.data(), r.data());
    double worst = 0;
    for (int lane = 0; lane < lanes_in<S>; ++lane) {
        const VectorXd& x = wanted[size_t(lane)];
        EXPECT_GT(x.norm(), 1e-3);
        for (int i = first; i < blocks; ++i) {
            const Vec3<S>& u = r[size_t(i)];
            const Eigen::Vector3d got(taken(u.x, lane), taken(u.y, lane), taken(u.z, lane));
            worst = std::max(worst, (got - x.segment<3>(3 * (i - first))).norm() / x.norm());
        }
    }
    return worst;
}

TEST(BlockSolve, five_diagonals_agree_with_a_dense_solve) {
    EXPECT_LT((solve_error<true, double>(0)), 1e-13);
    EXPECT_LT((solve_error<true, Pack<double>>(0)), 1e-13);
    EXPECT_LT((solve_error<true, Pack<float>>(0)), 1e-5);  // condition numbers here are below 100
}

TEST(BlockSolve, three_diagonals_agree_with_a_dense_solve) {
    EXPECT_LT((solve_error<false, double>(0)), 1e-13);
    EXPECT_LT((solve_error<false, Pack<double>>(0)), 1e-13);
    EXPECT_LT((solve_error<false, Pack<float>>(0)), 1e-5);
}

TEST(BlockSolve, rows_before_the_first_are_left_out) {
    EXPECT_LT((solve_error<true, Pack<double>>(2)), 1e-13);
    EXPECT_LT((solve_error<false, Pack<double>>(2)), 1e-13);
}

TEST(BlockSolve, factor_of_three_by_three_solves_vectors_and_matrices) {
    const Sym3<double> m{4, 1, -1, 3, 0.5, 5};
    const Vec3d b{1, -2, 3};
    const Factor3<double> f(m);
    EXPECT_LT(norm(m * f.solve(b) - b), 1e-14);
    const Mat3<double> rows{{1, 2, 3}, {-1, 0, 2}, {4, 1, 1}}, x = f.solve(rows);
    EXPECT_LT((eigen(to_mat3(m)) * eigen(x) - eigen(rows)).norm(), 1e-13);
}

}  // namespace
}  // namespace wetcurl
