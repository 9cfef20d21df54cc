#pragma once

#include <Eigen/Core>

namespace pdoik::detail {

/// What joints can do whose speed may change by so much in a step. A step is asked for by where it
/// leads: where the robot rests if it brakes as hard as it may from the end of the step on. So no
/// goal, joint limit or obstacle is met faster than can be braked before it.
///
/// With `drift`, the speed at which a goal moves that is followed, it leads to where the robot
/// would move with the goal if it braked to its speed. Allocates nothing after construction.
class Braking {
 public:
  /// @param lower, upper  Limits of positions, shape (n,), as of the others; all may be infinite.
  Braking(double period, Eigen::VectorXd lower, Eigen::VectorXd upper, Eigen::VectorXd speed,
          Eigen::VectorXd acceleration);

  /// Whether some joint's acceleration is limited: if not, a step leads to its own end.
  bool limited() const { return limited_; }
  double period() const { return period_; }
  bool moves() const { return limited_ && !velocity_.isZero(0.0); }
  /// What is farthest that a step may lead to, from rest or at full speed, shape (n,).
  const Eigen::VectorXd& farthest() const { return farthest_; }

  const Eigen::VectorXd& velocity() const { return velocity_; }
  /// Begin somewhere at a speed, shape (n,), empty for at rest.
  void begin(const Eigen::VectorXd& at, const Eigen::Ref<const Eigen::VectorXd>& velocity);
  /// Take in a step that was made.
  /// @param meets_goals  It leads to where the goals are met, so that they are followed from now
  /// on.
  /// @param held  Nothing was better than to brake: something is in the way of moving with them.
  void made(const Eigen::VectorXd& from, const Eigen::VectorXd& to, bool meets_goals, bool held);
  /// Whether a joint's speed changed by more than it may in that step.
  bool was_hard() const { return was_hard_; }
  bool follows() const { return limited_ && follows_; }
  /// How the goals move that are followed, shape (n,): what is faster than may be is a jump.
  void set_drift(const Eigen::VectorXd& drift);
  void stop_drifting() { drift_.setZero(); }

  /// Where a step may lead, each joint for itself.
  void box(const Eigen::VectorXd& from, Eigen::VectorXd& lower, Eigen::VectorXd& upper) const;
  /// Where a step leads that comes to rest where the last one would, or brakes as hard as it may.
  void gentlest(const Eigen::VectorXd& from, Eigen::VectorXd& aim) const;
  /// Where a step ends that leads to `aim`, and where the robot rests if it brakes from there.
  void place(const Eigen::VectorXd& from, const Eigen::VectorXd& aim, Eigen::VectorXd& next,
             Eigen::VectorXd& rest) const;

  /// The way from the end of a step to rest, for `between`. @returns What its length is by the
  /// lengths that one unit of each joint comes to, at most.
  double brake(const Eigen::VectorXd& from, const Eigen::VectorXd& next,
               const Eigen::VectorXd& displacement_bounds);
  /// The configuration after a share of that way, in lengths of which none is longer than given.
  void between(double share, Eigen::VectorXd& q) const;

 private:
  /// The speeds that a joint may have in a step from here: those that acceleration allows, and of
  /// these, or else nearest to them, those from which it rests inside its limits.
  struct Range {
    double slowest, fastest;
  };
  Range range(Eigen::Index i, double from) const;
  /// How far a joint comes in a step at a speed, and braking from there on.
  double way(Eigen::Index i, double speed) const;
  /// The speed at which it comes so far.
  double speed(Eigen::Index i, double way) const;

  double period_;
  bool limited_, follows_ = false, was_hard_ = false;
  Eigen::VectorXd lower_, upper_, most_, acceleration_, farthest_, velocity_, drift_, rest_;
  // The way on which it brakes.
  Eigen::VectorXd start_, begun_;
  double longest_ = 0.0;  ///< until all joints rest [s]
};

}  // namespace pdoik::detail
