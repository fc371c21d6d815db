// Vectors, quaternions, packs and the smoothing filter against algebra. Eq 2 and its adjoint.
#include <numbers>
#include <vector>

#include "base/geometry/filter.h"
#include "base/quads.h"
#include "scratch.h"

namespace wetcurl {
namespace {

using testing::Random;

constexpr double rounding = 1e-14;  // a few operations on numbers near one, in double

Vec3d turned(const Quatd& q, const Vec3d& v) { return rotate(q, v); }
double distance_between(const Vec3d& a, const Vec3d& b) { return norm(a - b); }

TEST(Vec3, cross_product_is_perpendicular_and_as_long_as_the_parallelogram) {
    Random random(1);
    for (int k = 0; k < 100; ++k) {
        const Vec3d a = random.vector(), b = random.vector(), c = cross(a, b);
        EXPECT_NEAR(dot(a, c), 0, rounding);
        EXPECT_NEAR(dot(b, c), 0, rounding);
        EXPECT_NEAR(dot(c, c), dot(a, a) * dot(b, b) - dot(a, b) * dot(a, b), rounding);
        EXPECT_GT(dot(a, a), 1e-4);
    }
}

TEST(Vec3, normalized_gives_a_unit_vector_or_the_one_that_was_offered) {
    const Vec3d other{0, 1, 0};
    EXPECT_NEAR(norm(normalized(Vec3d{1e-9, 2e-9, -2e-9}, other)), 1, rounding);
    EXPECT_EQ(normalized(Vec3d{0, 0, 0}, other).y, 1);
    EXPECT_EQ(normalized(Vec3f{1e-30f, 0, 0}, cast<float>(other)).y, 1);
}

TEST(Matrix, isotropic_plus_outer_acts_as_its_formula) {
    Random random(2);
    for (int k = 0; k < 20; ++k) {
        const double a = random.number(), b = random.number();
        const Vec3d n = random.direction(), v = random.vector();
        const Vec3d wanted = a * v + (b * dot(n, v)) * n;
        const Sym3<double> m = isotropic_plus_outer(a, b, n);
        EXPECT_LT(distance_between(m * v, wanted), rounding);
        EXPECT_LT(distance_between(to_mat3(m) * v, wanted), rounding);
        EXPECT_GT(norm(wanted), 1e-3);
    }
}

TEST(Matrix, transposed_product_is_the_adjoint) {
    Random random(3);
    const Mat3<double> m{random.vector(), random.vector(), random.vector()};
    const Vec3d u = random.vector(), v = random.vector();
    EXPECT_GT(std::abs(dot(u, m * v)), 1e-3);
    EXPECT_NEAR(dot(u, m * v), dot(transposed_times(m, u), v), rounding);
}

TEST(Quaternion, rotation_about_an_axis_turns_by_the_angle) {
    const double angle = 0.7;
    const Vec3d v = rotate(rotation_about({0, 0, 1}, angle), Vec3d{1, 0, 0});
    EXPECT_LT(distance_between(v, {std::cos(angle), std::sin(angle), 0}), rounding);
}

TEST(Quaternion, product_rotates_by_the_right_factor_first) {
    Random random(4);
    for (int k = 0; k < 50; ++k) {
        const Quatd p = random.rotation(), q = random.rotation();
        const Vec3d v = random.direction();
        EXPECT_LT(distance_between(rotate(p * q, v), rotate(p, rotate(q, v))), rounding);
        EXPECT_LT(distance_between(rotate(conjugate(q), rotate(q, v)), v), rounding);
        EXPECT_NEAR(norm(rotate(q, v)), 1, rounding);
    }
}

TEST(Pose, inverse_undoes_it) {
    Random random(5);
    const Pose pose{random.rotation(), random.vector(3)};
    const Vec3d x = random.vector();
    EXPECT_GT(distance_between(pose(x), x), 0.1);
    EXPECT_LT(distance_between(pose.inverse(pose(x)), x), rounding);
}

TEST(MinimalRotation, turns_one_direction_to_the_other_and_leaves_their_axis_alone) {
    Random random(6);
    for (int k = 0; k < 200; ++k) {
        const Vec3d a = random.direction(), b = random.direction();
        const Quatd q = minimal_rotation(a, b);
        EXPECT_LT(distance_between(rotate(q, a), b), 1e-12);
        const Vec3d axis = cross(a, b);
        EXPECT_LT(distance_between(rotate(q, axis), axis), 1e-12);
        // No further than it must: the angle is the one between them.
        EXPECT_NEAR(2 * std::acos(std::min(1.0, q.w)), std::acos(std::clamp(dot(a, b), -1.0, 1.0)), 1e-7);
    }
}

TEST(MinimalRotation, of_equal_directions_is_the_identity) {
    const Vec3d a = Random(7).direction();
    const Quatd q = minimal_rotation(a, a);
    EXPECT_NEAR(q.w, 1, rounding);
    EXPECT_LT(std::abs(q.x) + std::abs(q.y) + std::abs(q.z), rounding);
}

// The quaternion of near-opposed directions has a cross product of size `off`, good to eps / off.
template <class S>
void expect_opposed_directions_turn(double tolerance_per_offset) {
    Random random(8);
    for (int k = 0; k < 50; ++k) {
        const Vec3<S> a = normalized(cast<S>(random.direction()), Vec3<S>{S(1), S(0), S(0)});
        for (double off : {0.0, 1e-16, 1e-12, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
            const Vec3<S> side = cross(a, cast<S>(random.direction()));
            const Vec3<S> b = normalized(-a + S(off) * side, a);
            const Quat<S> q = minimal_rotation(a, b);
            const Vec3<S> turned = rotate(q, a);
            const double error = double(norm(turned - b));
            EXPECT_LT(error, tolerance_per_offset) << "off " << off;
            EXPECT_NEAR(double(norm(turned)), 1, 1e-5);
            EXPECT_NEAR(double(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z), 1, 1e-6);
        }
    }
}
// Worst where 1 + dot(a, b) drowns in rounding: off near the square root of epsilon.
TEST(MinimalRotation, turns_opposed_and_nearly_opposed_directions_in_double) {
    expect_opposed_directions_turn<double>(1e-6);
}
TEST(MinimalRotation, turns_opposed_and_nearly_opposed_directions_in_single) {
    expect_opposed_directions_turn<float>(3e-2);
}

template <class T>
class PackOf : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(PackOf, Scalars);

TYPED_TEST(PackOf, every_operation_equals_the_plain_one_to_the_bit) {
    using T = TypeParam;
    using P = Pack<T>;
    Random random(9);
    P a, b;
    for (int l = 0; l < P::lanes; ++l) {
        a.set(l, T(random.number(0.1, 2)));
        b.set(l, T(l % 3 ? random.number(0.1, 2) : double(a[l])));
    }
    P sum = a, difference = a, product = a;
    sum += b;
    difference -= b;
    product *= b;
    for (int l = 0; l < P::lanes; ++l) {
        const T x = a[l], y = b[l];
        EXPECT_EQ((a + b)[l], x + y);
        EXPECT_EQ((a - b)[l], x - y);
        EXPECT_EQ((a * b)[l], x * y);
        EXPECT_EQ((a / b)[l], x / y);
        EXPECT_EQ((-a)[l], -x);
        EXPECT_EQ(sum[l], x + y);
        EXPECT_EQ(difference[l], x - y);
        EXPECT_EQ(product[l], x * y);
        EXPECT_EQ(sqrt(a)[l], std::sqrt(x));
        EXPECT_EQ(maximum(a, b)[l], std::max(x, y));
        EXPECT_EQ(minimum(a, b)[l], std::min(x, y));
        EXPECT_EQ(select(a < b, a, P(T(7)))[l], x < y ? x : T(7));
        EXPECT_EQ(select(a > b, a, P(T(7)))[l], x > y ? x : T(7));
        EXPECT_EQ(select(a <= b, a, P(T(7)))[l], x <= y ? x : T(7));
    }
}

TYPED_TEST(PackOf, vector_formulas_equal_the_plain_ones_lane_by_lane) {
    using T = TypeParam;
    using P = Pack<T>;
    Random random(10);
    std::vector<Vec3<T>> a(P::lanes), b(P::lanes);
    Vec3<P> pa, pb;
    for (int l = 0; l < P::lanes; ++l) {
        a[l] = cast<T>(random.direction());
        b[l] = l == 0 ? -a[0] : cast<T>(random.direction());  // one lane takes the opposed branch
        pa.x.set(l, a[l].x), pa.y.set(l, a[l].y), pa.z.set(l, a[l].z);
        pb.x.set(l, b[l].x), pb.y.set(l, b[l].y), pb.z.set(l, b[l].z);
    }
    const Quat<P> pq = minimal_rotation(pa, pb);
    const Vec3<P> turned = rotate(pq, pa);
    for (int l = 0; l < P::lanes; ++l) {
        const Vec3<T> plain = rotate(minimal_rotation(a[l], b[l]), a[l]);
        EXPECT_NEAR(norm(pa)[l], norm(a[l]), 4 * std::numeric_limits<T>::epsilon());
        // Contraction may differ between the two, and near opposition it is enlarged.
        EXPECT_LT(norm(Vec3<T>{turned.x[l], turned.y[l], turned.z[l]} - plain), 1e-3);
        EXPECT_GT(norm(plain), T(0.9));
    }
}

// ---- Eq 2 ----

using Edges = std::vector<Vec3d>;

Edges random_edges(int n, unsigned seed) {
    Random random(seed);
    Edges e(static_cast<size_t>(n));
    for (auto& v : e) v = random.vector();
    return e;
}
template <class S = double>
std::vector<Vec3<S>> filtered(const std::vector<Vec3<S>>& e, double beta) {
    std::vector<Vec3<S>> d(e.size());
    smooth_edges<S>(
        int(e.size()), Plain<S>(beta), [&](int i) { return e[size_t(i)]; },
        [&](int i, const Vec3<S>& v) { d[size_t(i)] = v; });
    return d;
}
Edges adjoint(const Edges& g, double beta) {
    Edges y(g.size());
    smooth_edges_adjoint<double>(
        int(g.size()), beta, [&](int i) { return g[size_t(i)]; },
        [&](int i, const Vec3d& v) { y[size_t(i)] = v; });
    return y;
}
double largest(const Edges& a, const Edges& b) {
    double m = 0;
    for (size_t i = 0; i < a.size(); ++i) m = std::max(m, norm(a[i] - b[i]));
    return m;
}

class Filter : public ::testing::TestWithParam<double> {};  // alpha / l
double beta_of(double ratio) { return filter_beta(0.005, 0.005 * ratio); }
INSTANTIATE_TEST_SUITE_P(alpha_over_l, Filter, ::testing::Values(0.2, 1.0, 5.0, 20.0));

TEST_P(Filter, reproduces_a_constant_difference) {
    const Edges e(60, Vec3d{0.3, -0.8, 0.5});
    EXPECT_LT(largest(filtered(e, beta_of(GetParam())), e), 1e-12);
}

TEST_P(Filter, smooths) {
    const Edges e = random_edges(200, 11), d = filtered(e, beta_of(GetParam()));
    double before = 0, after = 0;
    for (size_t i = 51; i < e.size(); ++i) before += norm(e[i] - e[i - 1]), after += norm(d[i] - d[i - 1]);
    EXPECT_GT(before, 10);
    EXPECT_LT(after, before);
}

TEST_P(Filter, is_linear) {
    const double beta = beta_of(GetParam());
    const Edges a = random_edges(50, 12), b = random_edges(50, 13);
    Edges mix(50);
    for (size_t i = 0; i < 50; ++i) mix[i] = 1.7 * a[i] - 0.4 * b[i];
    const Edges ga = filtered(a, beta), gb = filtered(b, beta), g = filtered(mix, beta);
    for (size_t i = 0; i < 50; ++i) EXPECT_LT(norm(g[i] - (1.7 * ga[i] - 0.4 * gb[i])), 1e-13);
    EXPECT_GT(norm(g[30]), 1e-4);
}

TEST_P(Filter, commutes_with_rotation) {
    const double beta = beta_of(GetParam());
    const Quatd q = Random(14).rotation();
    const Edges e = random_edges(50, 15), d = filtered(e, beta);
    Edges turned_before(50), turned_after(50);
    for (size_t i = 0; i < 50; ++i) turned_before[i] = turned(q, e[i]), turned_after[i] = turned(q, d[i]);
    EXPECT_LT(largest(filtered(turned_before, beta), turned_after), 1e-13);
    EXPECT_GT(largest(d, turned_after), 1e-2);
}

TEST_P(Filter, adjoint_identity_holds_to_rounding) {
    const double beta = beta_of(GetParam());
    for (int n : {1, 2, 3, 5, 100}) {
        const Edges e = random_edges(n, 16), g = random_edges(n, 17), ge = filtered(e, beta),
                    gtg = adjoint(g, beta);
        double left = 0, right = 0, size = 0;
        for (size_t i = 0; i < e.size(); ++i) {
            left += dot(ge[i], g[i]);
            right += dot(e[i], gtg[i]);
            size += norm(ge[i]) * norm(g[i]);
        }
        EXPECT_GT(size, 1e-2);
        EXPECT_NEAR(left, right, 1e-13 * std::max(1.0, size)) << n << " edges";
    }
}

TEST_P(Filter, in_packs_equals_the_plain_filter_in_every_lane) {
    using P = Pack<float>;
    const double beta = beta_of(GetParam());
    const int n = 40;
    std::vector<std::vector<Vec3f>> plain(P::lanes, std::vector<Vec3f>(n));
    std::vector<Vec3<P>> packed(n);
    for (int l = 0; l < P::lanes; ++l) {
        const Edges e = random_edges(n, 100 + unsigned(l));
        for (int i = 0; i < n; ++i) {
            plain[l][i] = cast<float>(e[i]);
            packed[i].x.set(l, plain[l][i].x), packed[i].y.set(l, plain[l][i].y),
                packed[i].z.set(l, plain[l][i].z);
        }
    }
    const auto d = filtered<P>(packed, beta);
    for (int l = 0; l < P::lanes; ++l) {
        const auto wanted = filtered<float>(plain[l], beta);
        for (int i = 0; i < n; ++i)
            EXPECT_LT(norm(Vec3f{d[i].x[l], d[i].y[l], d[i].z[l]} - wanted[i]),
                      2e-5f);  // contraction differs
        EXPECT_GT(norm(wanted[n - 1]), 1e-4f);
    }
}

TEST(Quads, hold_four_numbers_each_and_one_number_each_and_their_own_sums) {
    using P = Pack<float>;
    const float from[] = {3, 5, 7, 11};
    P a, b, c, d;
    for (int l = 0; l < P::lanes; ++l)
        a.set(l, float(l)), b.set(l, float(l * l)), c.set(l, 1), d.set(l, l % 4 ? 0.f : float(l));
    const P four = in_each_quad(from), one = a_quad_each(from), sums = sums_of_quads(a, b, c, d);
    const uint32_t bits = 0x9d25;
    const P some = in_each_quad(from, bits);
    for (int q = 0; q < quads; ++q) {
        const int first = 4 * q;
        for (int l = 0; l < 4; ++l) {
            EXPECT_EQ(four[first + l], from[l]);
            EXPECT_EQ(some[first + l], bits >> (first + l) & 1 ? from[l] : 0);
            EXPECT_EQ(one[first + l], from[q]);
        }
        EXPECT_EQ(sums[first], float(4 * first + 6));
        EXPECT_EQ(sums[first + 1], float(4 * first * first + 12 * first + 14));
        EXPECT_EQ(sums[first + 2], 4);
        EXPECT_EQ(sums[first + 3], float(first));
    }
}

TEST(FilterLimit, alpha_to_zero_is_the_identity) {
    const Edges e = random_edges(50, 18);
    EXPECT_EQ(filter_beta(0.005, 0), 1);
    EXPECT_EQ(largest(filtered(e, 1), e), 0);
    EXPECT_EQ(largest(adjoint(e, 1), e), 0);
    // And on the way there: exp(-40) is the distance left.
    EXPECT_LT(largest(filtered(e, filter_beta(0.005, 0.005 / 40)), e), 1e-12);
}

TEST(FilterLimit, a_step_arrives_as_the_critically_damped_recursion_says) {
    // d_i = 1 - (1 + i beta) (1 - beta)^i after a step from 0 to 1 behind the first edge.
    const double beta = beta_of(5);
    Edges e(80, Vec3d{1, 0, 0});
    e[0] = {0, 0, 0};
    const Edges d = filtered(e, beta);
    for (int i = 1; i < 80; ++i)
        EXPECT_NEAR(d[size_t(i)].x, 1 - (1 + i * beta) * std::pow(1 - beta, i), 1e-13);
    EXPECT_GT(d[10].x, 0.1);
}

}  // namespace
}  // namespace wetcurl
