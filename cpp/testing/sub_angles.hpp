#pragma once

#include <Eigen/Core>
#include <cmath>

#include "pdoik/joint_limit_map.hpp"

/// The paper's M' variables, one per sub-angle, beside the map's one per joint.
namespace pdoik::testing {

/// Those that the map's variables stand for: of each joint all the same.
inline Eigen::VectorXd spread(const JointLimitMap& map, const Eigen::VectorXd& y) {
  Eigen::Index count = 0;
  for (int i = 0; i < map.size(); ++i) count += map.sub_angles(i);
  Eigen::VectorXd omega(count);
  Eigen::Index next = 0;
  for (int i = 0; i < map.size(); ++i) {
    const int K = map.sub_angles(i);
    omega.segment(next, K).setConstant(y[i] / std::sqrt(K));
    next += K;
  }
  return omega;
}

/// A gradient by them, as one by the map's variables.
inline Eigen::VectorXd gathered(const JointLimitMap& map, const Eigen::VectorXd& gradient) {
  Eigen::VectorXd result(map.size());
  Eigen::Index next = 0;
  for (int i = 0; i < map.size(); ++i) {
    const int K = map.sub_angles(i);
    result[i] = gradient.segment(next, K).sum() / std::sqrt(K);
    next += K;
  }
  return result;
}

}  // namespace pdoik::testing
