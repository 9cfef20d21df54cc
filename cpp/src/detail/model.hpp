#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "detail/hull_model.hpp"
#include "detail/low_discrepancy.hpp"
#include "detail/reach.hpp"
#include "pdoik/options.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// A robot and options as solves see them: what never changes, shared by all threads.
struct Model {
  Model(const Robot& robot, const Options& options);

  /// Whether a goal's target lies farther away than the links stretch.
  bool is_out_of_reach(const Goal& goal) const;
  /// Joints without limits stay within half a turn of a start: by wrapping q, or by bounds where a
  /// mimic joint follows at a rate that a whole turn would not leave unchanged.
  void wrap(const Eigen::VectorXd& start, Eigen::VectorXd& q) const;
  /// Those with limits a turn apart or more come as near to what is wanted as whole turns bring
  /// them between a solve's bounds, which are the limits or closer.
  void unwind(const Eigen::VectorXd& wanted, const Eigen::VectorXd& lower,
              const Eigen::VectorXd& upper, Eigen::VectorXd& q) const;
  /// Whether more joints move tips or hulls than goals fix.
  bool is_redundant(std::span<const Goal> goals) const;

  Robot robot;
  Options options;
  HullModel hulls;
  std::vector<bool> matters;  ///< joints that move a tip or a hull
  enum class Turn { Limited, Whole, Wrap, Bound };
  std::vector<Turn> turns;
  Eigen::VectorXd pull;  ///< of each joint to a posture [m^2/rad^2]
  LowDiscrepancy sequence;
  std::vector<Reach> tip_reach;
  /// What one unit of each joint moves any part of a hull by, at most, within limits: not all
  /// finite where a slide without limits lengthens them.
  Eigen::VectorXd levers;
  double narrowest;  ///< half the width of the thinnest hull, in bounds: how fine a way is cut [m]
};

}  // namespace pdoik::detail
