#include "detail/check_options.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace pdoik::detail {
namespace {

template <class Value>
void require(bool holds, const char* name, Value value, const char* expected) {
  if (holds) return;
  std::ostringstream message;
  message << name << " is " << value << ", expected " << expected;
  throw std::invalid_argument(message.str());
}

void require_positive(const char* name, double value) {
  require(value > 0.0 && std::isfinite(value), name, value, "a positive finite number");
}

}  // namespace

void check_options(const Options& o) {
  require_positive("position_tolerance", o.position_tolerance);
  require_positive("rotation_tolerance", o.rotation_tolerance);
  require(std::isfinite(o.clearance), "clearance", o.clearance, "a finite length [m]");
  require(o.clearance_tolerance >= 0.0 && std::isfinite(o.clearance_tolerance), "clearance_tolerance",
          o.clearance_tolerance, "a finite length of at least 0 [m]");
  require(o.max_time > 0.0, "max_time", o.max_time, "a positive time [s]");  // infinity is fine
  require(o.max_restarts >= 0, "max_restarts", o.max_restarts, "at least 0");
  require(o.max_obstacles >= 0, "max_obstacles", o.max_obstacles, "at least 0");
  require_positive("rotation_weight", o.rotation_weight);
  require_positive("collision_weight", o.collision_weight);
  require_positive("point_distance", o.point_distance);
  require(o.start_inset > 0.0 && o.start_inset < 0.5, "start_inset", o.start_inset, "a fraction in (0, 0.5)");
  const double length = o.goal_axis.norm();
  require(length > 1e-9 && std::isfinite(length), "goal_axis", length, "a direction, not a vector of this length");
}

}  // namespace pdoik::detail
