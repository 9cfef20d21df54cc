#pragma once

#include <Eigen/Core>
#include <vector>

#include "pdoik/goal.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

struct Model;

/// Configurations all over a robot's ranges, and where they put a tip: what comes nearest to a
/// target is a better start than a random one, and how near says how likely the target can be met.
class StartTable {
 public:
  struct Nearest {
    int row = 0;
    float off = 0.0F;  ///< squared, turns in metres by their weight [m^2]
  };

  StartTable(const Model& model, int tip);

  /// Whether it can tell of a goal: of a pose or a place in the base frame.
  static bool knows(const Goal& goal);
  Nearest nearest(const Goal& goal, double rotation_weight) const;
  /// Joint positions, shape (n,).
  auto q(int row) const { return configurations_.col(row); }

 private:
  static constexpr int kRows = 1024;

  Eigen::MatrixXd configurations_;  ///< (n, rows)
  /// The tip's place and its three axes, and the place's square: (rows, 13) by columns.
  Eigen::Matrix<float, Eigen::Dynamic, 13> frames_;
};

}  // namespace pdoik::detail
