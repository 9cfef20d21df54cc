#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "common/deadline.hpp"
#include "obstacles/scene.hpp"
#include "pdoik/joint_limit_map.hpp"
#include "pdoik/result.hpp"
#include "problem/judge.hpp"
#include "problem/lagrangian_problem.hpp"
#include "problem/least_squares_problem.hpp"
#include "problem/model.hpp"
#include "problem/problem.hpp"
#include "problem/tool_check.hpp"
#include "search/lane_search.hpp"

namespace pdoik::detail {

/// The memory of one thread that solves: the problem in both its forms, what minimises them, and
/// the judge. Nothing here allocates once it is made and has its scene.
class Workspace {
 public:
  Workspace(std::shared_ptr<const Model> model, const Scene& scene);
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  const Model& model() const { return *model_; }
  const Scene& scene() const { return *problem.scene; }
  /// The scene of the solves that follow, which outlives them: asked again whenever it has changed.
  void use(const Scene& scene);

  /// The clock that everything looks at from now on, which outlives what follows.
  void watch(const Deadline& deadline) {
    problem.deadline = &deadline;
    problem.constraints.watch(&deadline);
  }

  /// What a solve may take [s]: by the options, but for one that is part of something longer.
  double max_time() const { return max_time_ > 0.0 ? max_time_ : model_->options.max_time; }
  /// Let solves take so long from now on; 0 for what the options say.
  void give(double max_time) { max_time_ = max_time; }
  /// The clock of a solve that may take this long: time is kept for so many verdicts.
  Deadline deadline_in(double max_time, int verdicts = 1) const;
  /// How many verdicts there is time for.
  double verdicts_left() const { return problem.deadline->left() / std::max(verdict_time_, 1e-9); }
  /// Judge a configuration, a pass over what is near. Counts as late once the clock has struck.
  void judge(std::span<const Goal> asked, const Eigen::VectorXd& at, Result& result, double look);
  /// The same for a result that is returned.
  void judge(std::span<const Goal> asked, const Eigen::VectorXd& at, Result& result) {
    judge(asked, at, result, model_->options.report_clearance);
  }
  /// The same, of no solve.
  void judge_unwatched(std::span<const Goal> asked, const Eigen::VectorXd& at, Result& result) {
    problem.allowed_contact.set_goals(asked);
    judge_(asked, at, scene(), result);
  }
  /// Minimise least squares from x, which then holds the end. @returns The value there.
  double minimise(LevenbergMarquardt& minimiser, Eigen::VectorXd& x, const Eigen::VectorXd& lower,
                  const Eigen::VectorXd& upper, Result& result);
  /// Minimise the augmented Lagrangian (Algorithm IK) from omega.
  void minimise_lagrangian(Result& result);

 private:
  std::shared_ptr<const Model> model_;
  Judge judge_;
  AugmentedLagrangian augmented_lagrangian_;
  double max_time_ = 0.0;
  double verdict_time_ = 0.0;  ///< what a verdict takes, by the last ones [s]
  /// Of what the scene holds, and of the margins among links, that were last taken in.
  std::uint64_t attachments_stamp_ = 0, links_stamp_ = 0;

 public:
  Problem problem;
  JointLimitMap map;
  LagrangianProblem lagrangian;
  LeastSquaresProblem least_squares;
  /// Gives up soon, goes on while there is any progress, and while there is anything to gain, with
  /// a posture or with wishes.
  LevenbergMarquardt brisk, patient, settling, wishing;
  LaneSearch lanes;
  ToolCheck tool;
  std::function<bool()> interrupt;  ///< whether somebody wants a solve to end
  Eigen::VectorXd omega, q, start;  ///< for Algorithm IK
  Result saved;                     ///< a verdict to go back to
};

/// The patience of `patient`: where only one start will do, slow progress is still progress.
LevenbergMarquardtOptions patient(LevenbergMarquardtOptions options);

/// Go back to an earlier verdict, but not to how much work it took.
void restore(const Result& earlier, Result& result);

}  // namespace pdoik::detail
