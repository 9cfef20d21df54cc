#pragma once

#include <vector>

#include "common/quadratic_program.hpp"
#include "search/workspace.hpp"
#include "track/barriers.hpp"
#include "track/gate.hpp"

namespace pdoik::detail {

/// A step of a control loop from the last answer: what comes nearest to the goals inside what
/// barriers leave, taken as far as the gate lets it.
class Step {
 public:
  /// The workspace outlives it.
  explicit Step(Workspace& workspace);

  /// Tell how goals move that are followed, by those of the last call and where the robot is.
  void follow(std::span<const Goal> goals, const Eigen::VectorXd& from, Braking& braking);
  /// result.status is Solved, TimeLimit or Exhausted. Allocates nothing if result.q has its size.
  void take(const StepRequest& request, Result& result);
  /// Where the last step leads: to its end, or where the robot comes to rest.
  const Eigen::VectorXd& aim() const { return gate_.aim(); }

 private:
  /// Take in the goals: those that are farther than a step can bring a tip by what a step can, if
  /// that is wanted.
  void bring_near(const StepRequest& request, bool near);
  /// Candidates from one configuration on, each with what the last ones left.
  void go_on(const StepRequest& request, Result& result);
  /// Half the way to q_, a quarter, an eighth, or only out of what it is in, from a configuration.
  void take_a_part(const Eigen::VectorXd& about);
  /// The barriers about a configuration, and the box: a share of where the step may lead.
  /// @returns Whether the clock left time for it.
  bool look(const StepRequest& request, const Eigen::VectorXd& about, double stride);
  /// And about where the last candidate was in something.
  bool look_there(const Eigen::VectorXd& about);
  /// What comes nearest to goals inside them, into q_.
  void propose(const StepRequest& request, const Eigen::VectorXd& about, Result& result);
  /// What the quadratic model costs on a way from where it is linearised.
  double modelled(const Eigen::VectorXd& way);
  /// Gauss-Newton steps from q_, at most so many, with the pull to a posture or without.
  /// @returns What the goals cost there, where the problem then is.
  double descend(const Eigen::VectorXd& about, int turns, Result& result);
  /// No farther than the clock allows.
  bool late() const { return workspace_.problem.deadline->passed(); }

  Workspace& workspace_;
  const Model& model_;
  Gate gate_;
  Barriers barriers_;
  QuadraticProgram program_;
  Eigen::MatrixXd hessian_;
  Eigen::LLT<Eigen::MatrixXd, Eigen::Upper> factor_;
  std::vector<Goal> before_;  ///< goals of the last step
  Eigen::VectorXd gradient_, moved_, q_, pulled_, next_, least_, most_;
  bool brought_near_ = false;  ///< some goal
  double stride_ = 1.0;        ///< share of what joints may go while something stands
};

}  // namespace pdoik::detail
