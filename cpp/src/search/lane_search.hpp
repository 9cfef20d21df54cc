#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "pdoik/goal.hpp"
#include "pdoik/options.hpp"
#include "pdoik/robot.hpp"
#include "simd/lanes.hpp"

namespace pdoik::detail {

/// Searches for goals alone, side by side in the lanes of vector registers: what
/// LevenbergMarquardt does with a LeastSquaresProblem that has no constraint. What one lane comes
/// to does not depend on the others. Allocates at construction only.
class LaneSearch {
 public:
  /// The options outlive it.
  LaneSearch(const Robot& robot, const Options& options);

  int width() const { return kernel_.width; }

  /// Whether lanes can tell of such goals at all: not of the centre of mass, nor of wishes alone.
  bool knows(std::span<const Goal> goals) const;
  /// Whether these goals ask the same kind of thing of the same tips as those of the last
  /// `set_kind`: all lanes that run must.
  bool is_kind_of(std::span<const Goal> goals) const { return are_alike(goals, kind_); }
  static bool are_alike(std::span<const Goal> goals, std::span<const Goal> others);
  void set_kind(std::span<const Goal> goals);

  /// How long slow progress is still progress, see LevenbergMarquardtOptions.
  struct Patience {
    double stall_ratio;
    int stall_window;
  };
  /// Begin a search in a lane, from q moved inside the bounds.
  /// @param yields  Whether of goals whose position comes first it alone counts.
  void start(int lane, std::span<const Goal> goals, const Eigen::VectorXd& q,
             const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, Patience patience,
             bool yields = false);
  void stop(int lane) { problem_.state[lane] = static_cast<double>(LaneState::Idle); }

  /// One evaluation and one step in each lane that runs. @returns  A bit for each that has ended.
  unsigned tick() { return kernel_.tick(problem_); }

  /// What a lane has come to.
  struct End {
    bool reached;  ///< the goals, to their tolerances
    double value;  ///< of least squares; infinite before its first evaluation
    int iterations, evaluations;
  };
  End end(int lane, Eigen::VectorXd& q) const;

 private:
  void set(double* rows, int index, int lane, double value) const {
    rows[index * kernel_.width + lane] = value;
  }

  struct Tip {
    std::vector<int> chain, dofs;
    Frame T_body_tip;
  };
  struct alignas(kRowAlignment) Line {
    double numbers[kRowAlignment / sizeof(double)];
  };

  const Options& options_;
  LaneKernel kernel_ = best_lane_kernel();
  std::vector<RolloutJoint> joints_;
  std::vector<std::array<signed char, 3>> onto_;
  std::vector<Tip> tips_;
  std::vector<Goal> kind_;
  std::vector<LaneGoal> goals_;         ///< room for two a tip; as many as are hard
  std::vector<std::vector<int>> dofs_;  ///< of each
  std::vector<Line> memory_;
  LaneProblem problem_;
};

}  // namespace pdoik::detail
