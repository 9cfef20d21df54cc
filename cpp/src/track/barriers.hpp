#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/quadratic_program.hpp"
#include "problem/problem.hpp"

namespace pdoik::detail {

/// What a step may do near constraints, linearised where it begins: what is clear is come nearer to
/// by a share of its distance at most (a discrete barrier: Ames et al., European Control
/// Conference, 2019); what is not is left as far as can be.
class Barriers {
 public:
  explicit Barriers(const Model& model);

  /// Those of a problem's scene where its rollout is placed, c > -reach, that joints which go up to
  /// a step, shape (n,), can come near enough to; of many, the worst.
  /// @returns Whether the clock left time for it.
  bool find(Problem& problem, double reach, const Eigen::VectorXd& step);
  /// Besides, those where the rollout is placed now and something was found to be in something: of
  /// a link the capsule that is nearest there is often another than where the step begins, and what
  /// is linear bends.
  /// @param moved  How far that is from where they were found first, shape (n,).
  bool cut(Problem& problem, const Eigen::VectorXd& moved);
  /// Ask of what is violated no more than can be had within the box, about 0.
  void come_to_terms(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

  Inequalities within(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) const {
    return {rows_, most_, count_, lower, upper};
  }
  /// The shortest way out of what is violated, as far as there is one; 0 where nothing is. (n,)
  const Eigen::VectorXd& way_out() const { return out_; }

 private:
  /// One that was found, by its family's number and its place there.
  struct Found {
    double c;  ///< or not less
    int family, k;
  };
  /// What there is of a problem's scene, c > -reach_of(family, group) and > -reach; of many, the
  /// worst.
  template <class Reach>
  bool gather(Problem& problem, double reach, std::size_t most, Reach&& reach_of);
  /// As rows, each with what most(c, row) says that it may be, those with c > -reach.
  template <class Most>
  void add_rows(Problem& problem, double reach, Most&& most);
  /// Leave only the worst of what was found, the least bad of them last.
  void keep_worst(std::size_t most);

  Eigen::MatrixXd rows_, hessian_;
  Eigen::VectorXd most_, gradient_, out_, soft_;
  std::vector<Found> found_;
  QuadraticProgram program_;
  int count_ = 0, violated_ = 0;
};

}  // namespace pdoik::detail
