#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pdoik/pdoik.hpp"

/// What a deadline is tried on: a robot, a cloud about it, and goals of every kind.
namespace pdoik::bench {

using Cloud = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Goals of one kind. A solve takes them in turn, a tracker stays with each for a while.
struct Case {
  std::string name;
  std::vector<std::vector<Goal>> goals;
  bool in_base_hull = false;  ///< with one more point, in a hull that no joint moves
};

/// The shipped robot with its own tips, and its base link as a last one that no joint moves.
Robot robot_with_base_tip(const std::string& name);

/// Five kinds, without those that the cloud leaves no goals of: `clear` (a configuration that keeps
/// clear of the cloud has the tips there), `buried` (one that does not), `far` (out of reach),
/// `fixed tip` (of the link that no joint moves, off its place) and `base hull` (as the first, with
/// a point in a base hull).
/// @param count  Goals of each kind.
std::vector<Case> cases_among(const Robot& robot, const Cloud& cloud, int count,
                              std::uint32_t seed);

/// The middle of the base link's first hull [m]; none where it has none.
std::optional<Eigen::RowVector3d> point_in_base_hull(const Robot& robot);

}  // namespace pdoik::bench
