#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>

#include "brute_force.hpp"
#include "pdoik/solver.hpp"
#include "simd/cull.hpp"
#include "simd/roll_out.hpp"
#include "workbench.hpp"

namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

struct Kernel {
  const char* name;
  CullFunction cull;
  GapFunction capsule_gaps;
};

/// Those that this processor runs.
std::vector<Kernel> kernels() {
  std::vector<Kernel> all{{"baseline", cull_baseline, capsule_gaps_baseline}};
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    all.push_back({"avx2", cull_avx2, capsule_gaps_avx2});
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")) {
    all.push_back({"avx512", cull_avx512, capsule_gaps_avx512});
  }
#endif
  return all;
}

/// Obstacles and hulls as the kernels take them.
struct Coarse {
  Coarse(Random& random, int points, int hull_count, bool radii) {
    padded = (points + kLanes - 1) / kLanes * kLanes;
    for (std::vector<float>* v : {&x, &y, &z}) v->assign(static_cast<std::size_t>(padded), 1e15F);
    radius.assign(static_cast<std::size_t>(padded), 0.0F);
    for (std::size_t k = 0; k < static_cast<std::size_t>(points); ++k) {
      const Eigen::Vector3f p = random.point(1.0).cast<float>();
      x[k] = p.x(), y[k] = p.y(), z[k] = p.z();
      if (radii) radius[k] = static_cast<float>(random.uniform(0.0, 0.2));
    }
    for (int h = 0; h < hull_count; ++h) {
      HullQuery hull{};
      const Eigen::Vector3f centre = random.point(0.8).cast<float>();
      const Eigen::Vector3f half =
          h % 3 == 0 ? Eigen::Vector3f::Zero() : Eigen::Vector3f(random.point(0.3).cast<float>());
      std::copy_n(centre.data(), 3, hull.centre);
      std::copy_n(half.data(), 3, hull.half);
      hull.semi_major = half.norm() + static_cast<float>(random.uniform(0.05, 0.3));
      hulls.push_back(hull);
    }
  }
  std::vector<std::pair<int, int>> run(CullFunction cull) const {
    std::vector<NearPair> pairs(hulls.size() * static_cast<std::size_t>(padded) + 1);
    pairs.back() = {-7, -7};
    CullCursor at;
    const int count =
        cull({x.data(), y.data(), z.data(), radius.data(), padded, {}, {}, {}}, hulls.data(),
             static_cast<int>(hulls.size()), pairs.data(), static_cast<int>(pairs.size()) - 1, at);
    EXPECT_EQ(pairs.back().hull, -7) << "wrote beyond the room there is";
    std::vector<std::pair<int, int>> found;
    for (int k = 0; k < count; ++k)
      found.emplace_back(pairs[static_cast<std::size_t>(k)].hull,
                         pairs[static_cast<std::size_t>(k)].obstacle);
    return found;
  }
  /// By how much, in double, the half sum of distances to the foci is below the semi-major axis.
  double inside(int h, int j) const {
    const HullQuery& hull = hulls[static_cast<std::size_t>(h)];
    const auto k = static_cast<std::size_t>(j);
    const Eigen::Vector3d o(x[k], y[k], z[k]),
        centre(hull.centre[0], hull.centre[1], hull.centre[2]),
        half(hull.half[0], hull.half[1], hull.half[2]);
    return static_cast<double>(hull.semi_major) + radius[k] -
           0.5 * ((o - centre - half).norm() + (o - centre + half).norm());
  }
  std::vector<float> x, y, z, radius;
  std::vector<HullQuery> hulls;
  int padded;
};

TEST(Simd, every_kernel_finds_the_pairs_that_a_plain_loop_in_double_finds) {
  int found_in_all = 0;
  for (int seed = 1; seed <= 60; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const int points = random.integer(0, 70);
    const Coarse coarse(random, points, random.integer(0, 12), seed % 2 == 0);
    for (const Kernel& kernel : kernels()) {
      SCOPED_TRACE(std::string(kernel.name) + ", seed " + std::to_string(seed) + ", " +
                   std::to_string(points) + " points");
      const auto found = coarse.run(kernel.cull);
      found_in_all += static_cast<int>(found.size());
      for (const auto& pair : found) ASSERT_LT(pair.second, points) << "a padding point was found";
      for (int h = 0; h < static_cast<int>(coarse.hulls.size()); ++h) {
        for (int j = 0; j < points; ++j) {
          const double inside = coarse.inside(h, j);
          if (std::abs(inside) < 5e-6) continue;  // single precision decides there
          ASSERT_EQ(std::count(found.begin(), found.end(), std::pair(h, j)), inside > 0.0 ? 1 : 0)
              << h << " " << j << " " << inside;
        }
      }
    }
  }
  EXPECT_GT(found_in_all, 300 * static_cast<int>(kernels().size()));
}

TEST(Simd, no_kernel_finds_a_padding_point_however_near_a_hull_is_to_vanishing) {
  for (int seed = 1; seed <= 200; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    Coarse coarse(random, 1, 1, false);
    HullQuery& hull = coarse.hulls.front();
    const float side = static_cast<float>(random.uniform(0.01, 0.5));
    for (float& h : hull.half) h = side;  // towards the padding points
    const float half = side * std::sqrt(3.0F);
    for (float a = half * (1.0F - 4e-6F); a < half * (1.0F + 4e-6F); a = std::nextafter(a, 1e9F)) {
      hull.semi_major = a;
      for (const Kernel& kernel : kernels()) {
        for (const auto& pair : coarse.run(kernel.cull)) ASSERT_EQ(pair.second, 0) << kernel.name;
      }
    }
  }
}

TEST(Simd, every_kernel_gives_the_gaps_from_capsules_that_a_plain_loop_in_double_gives) {
  for (int seed = 1; seed <= 60; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const Coarse coarse(random, 3 * kLanes, 0, seed % 2 == 0);
    std::vector<CapsuleQuery> capsules(static_cast<std::size_t>(random.integer(1, 9)));
    std::vector<std::array<Eigen::Vector3d, 2>> ends;
    for (CapsuleQuery& each : capsules) {
      const Eigen::Vector3f a = random.point(0.8).cast<float>();
      const Eigen::Vector3f v = seed % 3 == 0 ? Eigen::Vector3f::Zero()  // balls
                                              : Eigen::Vector3f(random.point(0.4).cast<float>());
      std::copy_n(a.data(), 3, each.a);
      std::copy_n(v.data(), 3, each.v);
      each.inverse = seed % 3 == 0 ? 0.0F : 1.0F / v.squaredNorm();
      each.radius = static_cast<float>(random.uniform(0.01, 0.3));
      ends.push_back({a.cast<double>(), (a + v).cast<double>()});
    }
    for (const Kernel& kernel : kernels()) {
      SCOPED_TRACE(std::string(kernel.name) + ", seed " + std::to_string(seed));
      for (int first = 0; first < coarse.padded; first += kLanes) {
        float gaps[kLanes];
        kernel.capsule_gaps({coarse.x.data(),
                             coarse.y.data(),
                             coarse.z.data(),
                             coarse.radius.data(),
                             coarse.padded,
                             {},
                             {},
                             {}},
                            first, capsules.data(), static_cast<int>(capsules.size()), gaps);
        for (int k = 0; k < kLanes; ++k) {
          const auto j = static_cast<std::size_t>(first + k);
          const Eigen::Vector3d o(coarse.x[j], coarse.y[j], coarse.z[j]);
          double least = std::numeric_limits<double>::infinity();
          for (std::size_t c = 0; c < capsules.size(); ++c) {
            least = std::min(least, brute_force_segment_distance(o, ends[c][0], ends[c][1]) -
                                        static_cast<double>(capsules[c].radius));
          }
          ASSERT_NEAR(gaps[k], least - static_cast<double>(coarse.radius[j]), 2e-6);
        }
      }
    }
  }
}

TEST(Simd, every_rollout_kernel_gives_the_frames_of_robot_fk) {
  std::vector<RollOutFunction> roll_outs{roll_out_baseline};
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    roll_outs.push_back(roll_out_avx2);
#endif
  for (int seed = 1; seed <= 40; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = random_robot(random, kMixedTree);
    const Eigen::VectorXd q = random_configuration(robot, random);
    const Eigen::VectorXd cosine = q.array().cos(), sine = q.array().sin();
    std::vector<RolloutJoint> joints;
    for (const Body& body : robot.bodies()) {
      joints.push_back({body.parent, body.dof, body.prismatic, false, body.multiplier, body.offset,
                        to_frame(body.T_parent_joint)});
      const bool turns =
          !body.prismatic && body.dof >= 0 &&
          robot.joint_types()[static_cast<std::size_t>(body.dof)] != JointType::Prismatic;
      joints.back().plain = turns && body.multiplier == 1.0 && body.offset == 0.0;
    }
    std::vector<Eigen::Isometry3d> expected(joints.size());
    robot.body_poses(q, expected);
    for (const RollOutFunction roll_out : roll_outs) {
      std::vector<Frame> frames(joints.size(), to_frame(Eigen::Isometry3d::Identity()));
      roll_out(joints.data(), static_cast<int>(joints.size()), cosine.data(), sine.data(), q.data(),
               frames.data());
      for (std::size_t b = 0; b < joints.size(); ++b) {
        Eigen::Matrix3d R;
        R << to_vector3(frames[b].x), to_vector3(frames[b].y), to_vector3(frames[b].z);
        ASSERT_LT((R - expected[b].linear()).cwiseAbs().maxCoeff(), 1e-13) << "seed " << seed;
        const double scale = 1.0 + expected[b].translation().norm();
        ASSERT_LT((to_vector3(frames[b].p) - expected[b].translation()).norm(), 1e-13 * scale);
      }
    }
  }
}

TEST(Simd, baseline_and_best_kernel_give_the_same_minimisation) {
  for (int seed = 1; seed <= 15; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Eigen::VectorXd ends[2][2];
    for (const bool baseline : {true, false}) {
      Random random(static_cast<std::uint64_t>(seed));
      Robot robot = random_robot(random, {.joints = 7});
      robot.set_occupancy(random_occupancy(robot, random, 3, 5));
      Workbench bench(robot, {});
      if (baseline) bench.moving.use_baseline();
      bench.set_obstacles(random_obstacles(random, 45, 0.7, seed % 2 == 0 ? 0.05 : 0.0));
      bench.set_target(robot.fk(random_configuration(robot, random)));
      Eigen::VectorXd omega = random.vector(bench.map.size(), -1.0, 1.0),
                      q = bench.positions(omega);
      AugmentedLagrangian augmented(bench.map.size(), {}, bench.options.lbfgs);
      augmented.minimize(bench.lagrangian, omega);
      LevenbergMarquardt lm(robot.dof());
      lm.minimize(bench.least_squares, q, robot.lower(), robot.upper(), [] { return false; });
      ends[baseline][0] = bench.positions(omega);
      ends[baseline][1] = q;
    }
    // Pairs come in the same order, and those that only one kernel's rounding finds are outside and
    // pull nothing.
    EXPECT_LT((ends[0][0] - ends[1][0]).lpNorm<Eigen::Infinity>(), 1e-9);
    EXPECT_LT((ends[0][1] - ends[1][1]).lpNorm<Eigen::Infinity>(), 1e-9);
  }
}

}  // namespace
}  // namespace pdoik::detail
