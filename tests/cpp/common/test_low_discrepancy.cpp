#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "common/low_discrepancy.hpp"

/// The sequence that restarts follow, by its law.
namespace pdoik::detail {
namespace {

/// The root above 1 of x^(d+1) = x + 1, by halving.
double roberts_root(int d) {
  double low = 1.0, high = 2.0;
  for (int i = 0; i < 200; ++i) {
    const double x = 0.5 * (low + high);
    (std::pow(x, d + 1) < x + 1.0 ? low : high) = x;
  }
  return low;
}

double apart_on_circle(double a, double b) {
  const double x = std::abs(a - b);
  return std::min(x, 1.0 - x);
}

TEST(LowDiscrepancy, each_coordinate_goes_round_by_roberts_step) {
  EXPECT_NEAR(roberts_root(1), 1.618033988749895, 1e-15);  // the golden ratio
  EXPECT_NEAR(roberts_root(2), 1.324717957244746, 1e-15);  // the plastic number
  for (const int d : {1, 2, 3, 7, 19, 64}) {
    const LowDiscrepancy sequence(d, 5);
    const double root = roberts_root(d);
    for (int i = 0; i < d; ++i) {
      const double step = std::pow(root, -(i + 1));
      for (const std::int64_t k : {0, 1, 2, 9, 1000, 123456}) {
        const double expected = std::fmod(sequence(0, i) + static_cast<double>(k) * step, 1.0);
        EXPECT_LT(apart_on_circle(sequence(k, i), expected), 1e-14 * static_cast<double>(k + 10))
            << "dimension " << i << " of " << d << ", term " << k;
      }
    }
  }
}

TEST(LowDiscrepancy, starts_where_splitmix64_says) {
  // The generator's published first outputs for this seed.
  const std::array<std::uint64_t, 4> published{6457827717110365317U, 3203168211198807973U,
                                               9817491932198370423U, 4593380528125082431U};
  const LowDiscrepancy sequence(4, 1234567);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double first_53_bits =
        std::ldexp(static_cast<double>(published[static_cast<std::size_t>(i)] >> 11), -53);
    EXPECT_EQ(sequence(0, i), first_53_bits);
  }
}

TEST(LowDiscrepancy, values_are_in_the_unit_interval_and_never_one) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const LowDiscrepancy sequence(7, seed * 0x123456789ABCDEFU);
    for (std::int64_t k = 0; k < 3'000'000'000; k = 2 * k + 1) {
      for (Eigen::Index i = 0; i < 7; ++i) {
        ASSERT_GE(sequence(k, i), 0.0);
        ASSERT_LT(sequence(k, i), 1.0);
      }
    }
  }
}

TEST(LowDiscrepancy, a_seed_gives_one_sequence_whose_terms_are_the_same_in_whatever_order) {
  const LowDiscrepancy one(6, 42), same(6, 42);
  std::vector<double> forwards, backwards;
  for (std::int64_t k = 0; k < 100; ++k)
    for (Eigen::Index i = 0; i < 6; ++i) forwards.push_back(one(k, i));
  for (std::int64_t k = 100; k-- > 0;)
    for (Eigen::Index i = 6; i-- > 0;) backwards.push_back(same(k, i));
  std::reverse(backwards.begin(), backwards.end());
  EXPECT_EQ(forwards, backwards);
}

TEST(LowDiscrepancy, seeds_that_differ_give_starts_that_differ_in_every_coordinate) {
  std::vector<double> first_terms;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const LowDiscrepancy sequence(5, seed);
    for (Eigen::Index i = 0; i < 5; ++i) first_terms.push_back(sequence(0, i));
  }
  std::sort(first_terms.begin(), first_terms.end());
  EXPECT_EQ(std::adjacent_find(first_terms.begin(), first_terms.end()), first_terms.end());
  // And they are spread evenly: Kolmogorov's distance for 1000 values, at a level of 1e-6.
  double farthest = 0.0;
  for (std::size_t k = 0; k < first_terms.size(); ++k)
    farthest = std::max(farthest, std::abs(first_terms[k] - (static_cast<double>(k) + 0.5) / 1e3));
  EXPECT_LT(farthest, std::sqrt(-0.5 * std::log(0.5e-6) / 1e3));
}

using Points = std::vector<std::array<double, 2>>;

/// The star discrepancy: by how much, at worst, the share of points in a box [0, a) x [0, b) is off
/// its area. The worst box has the coordinates of points, or 1, as its sides.
double star_discrepancy(const Points& points) {
  std::vector<double> a{1.0}, b{1.0};
  for (const auto& p : points) a.push_back(p[0]), b.push_back(p[1]);
  double worst = 0.0;
  for (const double x : a) {
    for (const double y : b) {
      int open = 0, closed = 0;
      for (const auto& p : points) {
        open += p[0] < x && p[1] < y ? 1 : 0;
        closed += p[0] <= x && p[1] <= y ? 1 : 0;
      }
      const auto n = static_cast<double>(points.size());
      worst = std::max({worst, x * y - open / n, closed / n - x * y});
    }
  }
  return worst;
}

TEST(LowDiscrepancy, the_plane_is_covered_far_more_evenly_than_by_chance) {
  constexpr int kCount = 200;
  double worst = 0.0, best_by_chance = 1.0;
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const LowDiscrepancy sequence(2, seed);
    Points points, chance;
    for (std::int64_t k = 0; k < kCount; ++k) {
      points.push_back({sequence(k, 0), sequence(k, 1)});
      chance.push_back({uniform(generator), uniform(generator)});
    }
    worst = std::max(worst, star_discrepancy(points));
    best_by_chance = std::min(best_by_chance, star_discrepancy(chance));
  }
  RecordProperty("worst", std::to_string(worst));
  RecordProperty("best_by_chance", std::to_string(best_by_chance));
  EXPECT_LT(worst, 0.6 * best_by_chance);
}

}  // namespace
}  // namespace pdoik::detail
