#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "peer.h"

namespace pdoik::bench {

/// Says whether a robot's hulls touch obstacle points, for solvers that know no obstacles: they
/// throw such answers away.
///
/// Hulls that move together share a bounding ball, which sorts out most points before any hull is
/// looked at, and each hull has its own. What is left is tested exactly.
class ObstacleCheck {
 public:
  /// Which of the solver's frames carries a link, and where the link is in it.
  struct Carrier {
    int frame;
    Eigen::Isometry3d T_frame_link;
  };

  /// @param occupancy_yaml  As load_occupancy takes it; null for no hulls.
  /// @throws LoadError  What load_occupancy throws.
  /// @throws std::invalid_argument naming a spheroid between two links.
  ObstacleCheck(const char* occupancy_yaml,
                const std::function<Carrier(const std::string& link)>& carrier);

  void set_points(const PeerProblem& problem);

  /// @param place  Vector3d(int frame, const Vector3d& local): where a frame's point is now.
  template <class Place>
  bool touches(Place&& place) {
    if (points_.empty()) return false;
    for (const Group& group : groups_) {
      const std::size_t count = gather(place(group.frame, group.center), group.radius);
      if (count == 0) continue;
      for (const Hull& hull : group.hulls) {
        const Hull placed{place(group.frame, hull.focus_a), place(group.frame, hull.focus_b),
                          hull.semi_major, hull.semi_minor};
        if (touches(placed, count)) return true;
      }
    }
    return false;
  }

 private:
  struct Hull {
    Eigen::Vector3d focus_a, focus_b;
    double semi_major, semi_minor;

    Eigen::Vector3d center() const { return 0.5 * (focus_a + focus_b); }
  };
  struct Group {
    int frame;
    std::vector<Hull> hulls{};
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    double radius = 0.0;
  };
  struct Point {
    double x, y, z, radius;

    Eigen::Vector3d position() const { return {x, y, z}; }
    /// Whether it reaches into a ball.
    bool reaches(const Eigen::Vector3d& center, double ball) const {
      const double dx = x - center.x(), dy = y - center.y(), dz = z - center.z();
      const double reach = ball + radius;
      return dx * dx + dy * dy + dz * dz < reach * reach;
    }
  };

  void add(const Carrier& carrier, const Eigen::Vector3d& focus_a, const Eigen::Vector3d& focus_b,
           double semi_major);
  /// The points that reach into a ball, to the front of near_; how many they are.
  std::size_t gather(const Eigen::Vector3d& center, double radius);
  /// Whether one of the first `count` of near_ touches a hull in the base frame.
  bool touches(const Hull& hull, std::size_t count) const;
  static bool touches(const Hull& hull, const Point& point);

  std::vector<Group> groups_;
  std::vector<Point> points_, near_;
};

}  // namespace pdoik::bench
