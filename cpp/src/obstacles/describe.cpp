#include "obstacles/describe.hpp"

namespace pdoik::detail {
namespace {

std::string balance_name(int index) {
  constexpr const char* kSides[] = {"lower x", "upper x", "lower y",
                                    "upper y", "lower z", "upper z"};
  return index < 6 ? std::string(kSides[index]) + " of the centre of mass"
                   : "support polygon of the centre of mass";
}

}  // namespace

std::string hull_name(const Occupancy& occupancy, int index) {
  const auto hull = static_cast<std::size_t>(index);
  if (hull < occupancy.spheres.size())
    return occupancy.spheres[hull].link + " (sphere " + std::to_string(hull) + ")";
  const std::size_t k = hull - occupancy.spheres.size();
  if (k >= occupancy.spheroids.size()) {
    const std::size_t c = k - occupancy.spheroids.size();
    return occupancy.capsules[c].link + " (capsule " + std::to_string(c) + ")";
  }
  const Spheroid& s = occupancy.spheroids[k];
  return s.link_a + (s.link_a == s.link_b ? "" : " to " + s.link_b) + " (spheroid " +
         std::to_string(k) + ")";
}

std::string describe(const WorstConstraint& worst, const Robot& robot, const Scene& scene) {
  using Kind = WorstConstraint::Kind;
  const Occupancy& occupancy = robot.occupancy();
  const auto of_tip = [&] {  // where there is but one, all know which
    return robot.tips().size() == 1
               ? std::string()
               : " of " + robot.tip_links()[static_cast<std::size_t>(worst.index)];
  };
  // A scene may have changed since.
  const auto shape_name = [&] {
    return worst.obstacle < scene.shapes().count() ? scene.shapes().shape(worst.obstacle).name
                                                   : std::string("a shape");
  };
  const auto name_of_attached = [&](int k) {
    return k < scene.attachments().count() ? scene.attachments()[k].shape.name
                                           : std::string("what was attached");
  };
  const auto attached_name = [&] {
    return "clearance of " + name_of_attached(worst.index) + " to ";
  };
  switch (worst.kind) {
    case Kind::None:
      return "none";
    case Kind::Position:
      return "position" + of_tip();
    case Kind::Rotation:
      return "rotation" + of_tip();
    case Kind::Limit:
      return "limit of " + robot.joint_names()[static_cast<std::size_t>(worst.index)];
    case Kind::Clearance:
      return "clearance of " + hull_name(occupancy, worst.index) + " to obstacle " +
             std::to_string(worst.obstacle);
    case Kind::Shape:
      return "clearance of " + hull_name(occupancy, worst.index) + " to " + shape_name();
    case Kind::Balance:
      return balance_name(worst.index);
    case Kind::SelfCollision:
      return "clearance of " + hull_name(occupancy, worst.index) + " to " +
             hull_name(occupancy, worst.obstacle);
    case Kind::AttachmentPoint:
      return attached_name() + "obstacle " + std::to_string(worst.obstacle);
    case Kind::AttachmentShape:
      return attached_name() + shape_name();
    case Kind::AttachmentHull:
      return attached_name() + hull_name(occupancy, worst.obstacle);
    case Kind::AttachmentAttachment:
      return attached_name() + name_of_attached(worst.obstacle);
  }
  return "none";
}

}  // namespace pdoik::detail
