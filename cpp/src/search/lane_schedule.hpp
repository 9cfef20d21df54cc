#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "search/solve_state.hpp"
#include "search/workspace.hpp"

namespace pdoik::detail {

/// Which starts of which solves are searched from in the lanes of vector registers. A solve has one
/// lane while there are more solves, and its later starts run beside the first ones when there are
/// not.
class LaneSchedule {
 public:
  /// The workspace outlives it.
  explicit LaneSchedule(Workspace& workspace);

  /// At least 1: how many solves there may be at once.
  std::size_t count() const { return std::max<std::size_t>(lanes_.size(), 1); }
  /// Whether lanes know the goals of a request, all of one kind: balance is not kept by goals
  /// alone, and the paper's form is another.
  bool knows(const Request& request) const;
  /// Let lanes search for goals of a request's kind. @returns Whether they do.
  /// @param busy  Whether lanes run, which must go on with their kind.
  bool take_kind(const Request& request, bool busy);
  /// Give each idle lane a start of the solve that has the fewest, let all go on by a step, and
  /// fill in the trials of those that end.
  void step(std::span<SolveState> solves);
  /// Let lanes run no more for a solve: what they have come to may be the best that there is.
  void stop(SolveState& solve);

 private:
  struct Lane {
    SolveState* solve = nullptr;
    Trial* trial = nullptr;
  };

  void fill(std::span<SolveState> solves);
  /// Of those that may start another search.
  SolveState* who_has_fewest(std::span<SolveState> solves) const;

  Workspace& workspace_;
  std::vector<Lane> lanes_;
  Eigen::VectorXd q_;
};

}  // namespace pdoik::detail
