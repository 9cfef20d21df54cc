#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "common/frame.hpp"
#include "kinematics/rollout.hpp"
#include "pdoik/goal.hpp"
#include "pdoik/options.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// Where the centre of mass is and has to be (Eq. com): constraints c <= 0 in metres.
///
/// Slots 0 to 5 are the box's sides, com_lower - c and c - com_upper by turns; slot 6 + k is the
/// edge of the support polygon that begins at contact point k, seen along `up`: the distance by
/// which c lies beyond the edge, plus the margin. The polygon moves with its links.
class Balance {
 public:
  static constexpr int kBox = 6;

  /// @throws std::invalid_argument naming an unknown link, fewer than three contact points, a box
  /// that is empty, an `up` of no direction, or a robot without mass.
  Balance(const Robot& robot, const BalanceOptions& options);

  bool wanted() const { return wanted_ || is_asked_; }
  /// What goals ask of the centre of mass from now on, beside the options.
  void ask(std::span<const Goal> goals);
  int slots() const { return kBox + static_cast<int>(points_.size()); }

  /// Take the bodies from where a rollout or a judge has them: Frame frame(int body).
  template <class FrameOf>
  void place(FrameOf&& frame) {
    for (std::size_t b = 0; b < mass_.size(); ++b) {
      moment_[b] = mass_[b] > 0.0
                       ? broadcast(mass_[b]) * transform(frame(static_cast<int>(b)), local_com_[b])
                       : Vec4{};
    }
    com_ = Vec4{};
    for (const Vec4& moment : moment_) com_ += moment;
    for (std::size_t k = 0; k < points_.size(); ++k)
      position_[k] = transform(frame(body_of_point_[k]), points_[k]);
    find_polygon();
  }

  const Vec4& com() const { return com_; }

  /// One constraint and its derivatives by the centre of mass and by the contact points of its
  /// edge, if it is one.
  struct Term {
    int slot = -1;
    double c = 0.0;
    Vec4 dc_dcom{};
    int a = -1, b = -1;
    Vec4 dc_da{}, dc_db{};
  };
  /// Calls visit(const Term&) for the constraints with c > -reach(slot).
  template <class Reach, class Visit>
  void for_each(Reach&& reach, Visit&& visit) const {
    for (int side = 0; side < kBox; ++side) {
      const double c = box_constraint(side);
      if (c <= -reach(side)) continue;  // what is no number counts
      Term term{side, c, {}, -1, -1, {}, {}};
      term.dc_dcom[side / 2] = side % 2 == 0 ? -1.0 : 1.0;
      visit(term);
    }
    const bool is_flat = corner_count_ == 2;  // all contacts on one line
    for (int k = 0; k < (is_flat ? 1 : corner_count_); ++k) {
      const Term term = is_flat ? segment_constraint() : edge_constraint(k);
      if (!(term.c <= -reach(term.slot))) visit(term);
    }
  }

  /// Add to row, shape (n,), the constraint's derivative by q. `rollout` must be where `place` took
  /// the bodies from.
  void add_row(const Term& term, const Rollout& rollout, double* row);
  /// Add dL/dT of all bodies for dL/dc = slope (the first half of the reverse pass).
  void add_wrenches(const Term& term, double slope, Rollout& rollout) const;

 private:
  double box_constraint(int side) const {
    const int axis = side / 2;
    return side % 2 == 0 ? lower_[axis] - com_[axis] : com_[axis] - upper_[axis];
  }
  Term edge_constraint(int k) const;
  /// Of a polygon that is a line or a point: the distance from it, plus the margin.
  Term segment_constraint() const;
  void find_polygon();

  BalanceOptions options_;
  bool wanted_, is_asked_ = false;
  Eigen::Vector3d lower_, upper_;  ///< of the box
  Vec4 up_;
  std::vector<double> mass_;          ///< of each body, as a fraction of the whole
  std::vector<Vec4> local_com_;       ///< in its frame
  std::vector<Vec4> moment_;          ///< mass times centre, where placed
  std::vector<double> subtree_mass_;  ///< of each body and all that it carries
  std::vector<Vec4> subtree_moment_;
  std::vector<int> parent_;
  std::vector<int> body_of_point_;
  std::vector<Vec4> points_, position_;  ///< contact points: in their bodies' frames; where placed
  Eigen::Vector3d side_, ahead_;         ///< with up a right-handed frame
  std::vector<Eigen::Vector2d> flat_;
  std::vector<int> order_, corners_;  ///< scratch; the polygon's corners, counter-clockwise
  int corner_count_ = 0;
  Vec4 com_{};
};

}  // namespace pdoik::detail
