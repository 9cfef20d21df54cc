#pragma once

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "common/low_discrepancy.hpp"
#include "hulls/hull_model.hpp"
#include "kinematics/closed_form.hpp"
#include "kinematics/reach.hpp"
#include "pdoik/options.hpp"
#include "pdoik/robot.hpp"
#include "problem/start_table.hpp"

namespace pdoik::detail {

/// A robot and options as solves see them: what never changes, shared by all threads.
struct Model {
  Model(const Robot& robot, const Options& options);

  /// How much farther away a goal's target lies than the links stretch, 0 where it does not [m].
  double beyond_reach(const Goal& goal) const;
  /// Joints without limits stay within half a turn of a start: by wrapping q, or by bounds where a
  /// mimic joint follows at a rate that a whole turn would not leave unchanged.
  void wrap(const Eigen::VectorXd& start, Eigen::VectorXd& q) const;
  /// Those with limits a turn apart or more come as near to what is wanted as whole turns bring
  /// them between a solve's bounds, which are the limits or closer.
  void unwind(const Eigen::VectorXd& wanted, const Eigen::VectorXd& lower,
              const Eigen::VectorXd& upper, Eigen::VectorXd& q) const;
  /// Whether more joints move tips or hulls than goals fix.
  bool is_redundant(std::span<const Goal> goals) const;
  /// Whether of each goal as many joints move the tip as it fixes degrees of freedom.
  bool has_joints_for(std::span<const Goal> goals) const;
  /// How many joints move a body.
  int joints_of(int body) const;

  Robot robot;
  Options options;
  HullModel hulls;
  HullModel whole;            ///< of all links; empty unless the robot keeps off itself
  std::vector<bool> matters;  ///< joints that move a tip or a hull
  enum class Turn { Limited, Whole, Wrap, Bound };
  std::vector<Turn> turns;
  Eigen::VectorXd pull;  ///< of each joint to a posture [m^2/rad^2]
  LowDiscrepancy sequence;
  std::vector<Reach> tip_reach;
  std::vector<ClosedForm> closed_forms;  ///< of each tip
  /// Where to start for a tip's targets: made when first asked for.
  const StartTable& starts_for(int tip) const;
  /// What one unit of each joint moves any part of a hull by, at most, within limits: not all
  /// finite where a slide without limits lengthens them.
  Eigen::VectorXd displacement_bounds;

  double narrowest;  ///< half the width of the thinnest hull, in bounds: how fine a way is cut [m]

 private:
  mutable std::vector<std::unique_ptr<StartTable>> start_tables_;
  mutable std::mutex start_tables_mutex_;
};

}  // namespace pdoik::detail
