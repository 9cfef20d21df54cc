#pragma once

#include <Eigen/Core>
#include <vector>

#include "detail/problem.hpp"
#include "detail/quadratic_program.hpp"

namespace pdoik::detail {

/// What a step may do near constraints, linearised where it begins: what is clear is come nearer to
/// by a share of its distance at most (a discrete barrier: Ames et al., European Control
/// Conference, 2019); what is not is left as far as can be.
class Barriers {
 public:
  explicit Barriers(const Model& model);

  /// Those of a problem's scene where its rollout is placed, c > -reach; of many, the worst.
  /// @param stand_off  What counts as contact begins this far before it [m].
  /// @returns Whether the clock left time for it.
  bool find(Problem& problem, double reach, double stand_off);
  /// Ask of what is violated no more than can be had within the box, about 0.
  void come_to_terms(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

  Inequalities within(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) const {
    return {rows_, most_, count_, lower, upper};
  }
  /// Whether all that is violated can be left within the box.
  bool met() const { return met_; }
  /// The shortest way out of what is violated, as far as there is one; 0 where nothing is. (n,)
  const Eigen::VectorXd& way_out() const { return out_; }

 private:
  /// One that was found, by its family's number and its place there.
  struct Found {
    double c;
    int family, k;
  };
  /// Leave only the worst of what was found.
  void keep_worst();

  Eigen::MatrixXd rows_, hessian_;
  Eigen::VectorXd most_, gradient_, out_, soft_;
  std::vector<Found> found_;
  QuadraticProgram program_;
  int count_ = 0, violated_ = 0;
  bool met_ = true;
};

}  // namespace pdoik::detail
