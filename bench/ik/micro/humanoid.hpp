#pragma once

#include <vector>

#include "pdoik/pdoik.hpp"

/// The H1 on its left foot, the right one welded as well, dodging a ball that swings by its head.
namespace pdoik::bench {

/// Both ankles face -y and are a hip's width apart; the world's z is up.
struct Standing {
  Robot robot;
  Goal right_foot;
  Eigen::VectorXd q0;  ///< a posture to stand in

  Standing();

  /// Both feet, the centre of mass in a box, its hulls off one another.
  Options options() const;
  /// Where it would like to be at time t: hips, knees, torso and arms go to and fro [s].
  Eigen::VectorXd posture(double t) const;
};

/// A ball of 168 points that goes back and forth in front of the chest, at time t [s].
Points swinging_ball(double t);

}  // namespace pdoik::bench
