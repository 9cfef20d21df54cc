#pragma once

#include <Eigen/Core>
#include <vector>

#include "pdoik/solver.hpp"
#include "problem/model.hpp"

namespace pdoik::detail {

/// The distinct solutions that a request has come to, and how much of what can be found that is.
class Collection {
 public:
  Collection(const Model& model, const AllOptions& wanted)
      : model_(model),
        wanted_(wanted),
        distinct_(wanted.distinct > 0.0 ? wanted.distinct : kDistinct) {}

  /// What is started from is all there need be.
  void expect_no_others() {
    whole_ = true;
    if (wanted_.distinct == 0.0) distinct_ = kDistinctBranches;
  }
  bool expects_no_others() const { return whole_; }

  /// An end that meets the goals, clear of everything or not.
  void note(const Eigen::VectorXd& q);
  /// A solution. @returns Whether it is a new one.
  bool add(const Result& result);
  /// Whether no more are wanted, or none are to be expected.
  bool is_full() const;

  /// The share of ends that one may expect to be known already.
  double coverage() const;
  std::vector<Result> results;

 private:
  bool are_alike(const Eigen::VectorXd& one, const Eigen::VectorXd& other) const;

  /// Two solutions of a continuum are others if a joint is farther off than this; two branches, if
  /// one is farther than rounding and tolerances blur where branches meet [rad] or [m].
  static constexpr double kDistinct = 0.1, kDistinctBranches = 1e-3;

  const Model& model_;
  AllOptions wanted_;
  double distinct_;
  bool whole_ = false;
  struct End {
    Eigen::VectorXd q;
    int hits;
  };
  std::vector<End> ends_;
  int noted_ = 0, once_ = 0, since_new_ = 0;
};

}  // namespace pdoik::detail
