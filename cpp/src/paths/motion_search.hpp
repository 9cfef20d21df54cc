#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "paths/sweep.hpp"

namespace pdoik::detail {

/// A move between configurations, clear of everything: two trees that grow towards each other
/// (Kuffner and LaValle's RRT-Connect), on ways that are swept; then shortened.
class MotionSearch {
 public:
  /// All of these outlive it. The goals say what may be touched.
  MotionSearch(Workspace& workspace, Sweep& sweep, std::span<const Goal> goals,
               const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
               const Deadline& deadline);

  using Way = std::vector<Eigen::VectorXd>;
  /// From a clear configuration to one of several that are. @returns Nothing if time is up.
  /// @param reached  Which of them.
  std::optional<Way> find(const Eigen::VectorXd& from, const Way& to, int& reached);
  /// Take detours out of a way, until nothing is gained any more or the share of time is over.
  void shorten(Way& way, double seconds);

 private:
  struct Tree {
    std::vector<double> configurations;  ///< one after the other
    std::vector<int> parents;
    explicit Tree(Eigen::Index dof) : dof_(dof) {}
    int size() const { return static_cast<int>(parents.size()); }
    Eigen::Map<const Eigen::VectorXd> q(int node) const {
      return {configurations.data() + node * dof_, dof_};
    }
    void add(const Eigen::VectorXd& q, int parent);
    int nearest(const Eigen::VectorXd& q) const;

   private:
    Eigen::Index dof_;
  };
  /// Go from a node towards a configuration as far as it is clear. @returns The share of the way.
  double grow(Tree& tree, int from, const Eigen::VectorXd& to, bool all_or_nothing);
  void sample(Eigen::VectorXd& q);
  double random();
  Way way_to(const Tree& tree, int node) const;
  bool is_clear(const Eigen::VectorXd& one, const Eigen::VectorXd& other);

  Workspace& workspace_;
  Sweep& sweep_;
  std::span<const Goal> goals_;
  const Eigen::VectorXd &lower_, &upper_;
  const Deadline& deadline_;
  std::uint64_t state_ = 0x9E3779B97F4A7C15ULL;
};

/// The sum of |dq| along a way.
double length_of(const MotionSearch::Way& way);

}  // namespace pdoik::detail
