#include "hulls/allowed_contact.hpp"

#include "hulls/hull_model.hpp"

namespace pdoik::detail {

AllowedContact::AllowedContact(const Robot& robot, const TouchOptions& options)
    : centres_(kMostGoals), radius2_(options.radius * options.radius), depth_(options.depth) {
  std::vector<bool> links(robot.link_names().size(), false);
  for (const std::string& name : options.links)
    links[static_cast<std::size_t>(robot.link_index(name))] = true;
  if (options.links.empty()) {
    for (std::size_t link = 0; link < links.size(); ++link) {
      const int body = robot.body_of_link(static_cast<int>(link));
      links[link] = std::any_of(robot.tips().begin(), robot.tips().end(), [&](int tip) {
        return ends_with(robot, body, robot.body_of_link(tip));
      });
    }
  }
  if (!(options.radius > 0.0)) return;
  const auto add = [&](const std::string& link) {
    may_touch_.push_back(links[static_cast<std::size_t>(robot.link_index(link))]);
  };
  for (const Sphere& sphere : robot.occupancy().spheres) add(sphere.link);
  for (const Spheroid& s : robot.occupancy().spheroids) {
    add(s.link_a);
    may_touch_.back() =
        may_touch_.back() && links[static_cast<std::size_t>(robot.link_index(s.link_b))];
  }
  for (const Capsule& capsule : robot.occupancy().capsules) add(capsule.link);
}

}  // namespace pdoik::detail
