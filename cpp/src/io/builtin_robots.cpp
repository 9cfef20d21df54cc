#include <stdexcept>

#include "common/text.hpp"
#include "io/embedded_robots.hpp"
#include "pdoik/collision_pairs.hpp"
#include "pdoik/robot.hpp"

namespace pdoik {

std::vector<std::string> Robot::builtin_names() {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < detail::embedded_robot_count; ++i) {
    names.emplace_back(detail::embedded_robots[i].name);
  }
  return names;
}

namespace {

const detail::EmbeddedRobot& embedded_robot(const std::string& name) {
  for (std::size_t i = 0; i < detail::embedded_robot_count; ++i) {
    if (name == detail::embedded_robots[i].name) return detail::embedded_robots[i];
  }
  throw std::invalid_argument("name is '" + name + "', expected one of " +
                              detail::join(Robot::builtin_names()));
}

}  // namespace

RobotDescription builtin_description(const std::string& name) {
  return load_urdf(embedded_robot(name).urdf);
}

Robot Robot::builtin(const std::string& name, const std::string& base_link,
                     const std::vector<std::string>& tip_links) {
  const detail::EmbeddedRobot& embedded = embedded_robot(name);
  Robot robot(load_urdf(embedded.urdf), base_link, tip_links);
  if (*embedded.occupancy != 0) robot.set_occupancy(load_occupancy(embedded.occupancy));
  if (*embedded.srdf != 0) robot.set_ignored_pairs(load_srdf_pairs(embedded.srdf));
  return robot;
}

}  // namespace pdoik
