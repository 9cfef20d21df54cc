#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "pdoik/errors.hpp"
#include "pdoik/floating_base.hpp"
#include "pdoik/robot.hpp"
#include "property.hpp"

/// Bytes as a URDF: a robot that is sound, or LoadError.
namespace pdoik {
namespace {

/// What every robot promises that could be built.
void check_robot(const Robot& robot) {
  const Eigen::Index n = robot.dof();
  PDOIK_PROPERTY(robot.lower().size() == n && robot.upper().size() == n);
  PDOIK_PROPERTY(robot.velocity().size() == n && robot.effort().size() == n);
  for (Eigen::Index i = 0; i < n; ++i) {
    PDOIK_PROPERTY(robot.lower()[i] <= robot.upper()[i], "joint " << i);
    PDOIK_PROPERTY(std::isfinite(robot.lower()[i]) || robot.lower()[i] < 0.0, "joint " << i);
    PDOIK_PROPERTY(robot.velocity()[i] >= 0.0, "joint " << i << ": " << robot.velocity()[i]);
    PDOIK_PROPERTY(robot.effort()[i] >= 0.0, "joint " << i << ": " << robot.effort()[i]);
  }
  PDOIK_PROPERTY(robot.mid_configuration().allFinite());
  for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
    const Body& body = robot.bodies()[b];
    PDOIK_PROPERTY(body.parent >= 0 && body.parent < static_cast<int>(b));
    PDOIK_PROPERTY(body.dof >= 0 && body.dof < n);
    PDOIK_PROPERTY(std::isfinite(body.multiplier) && std::isfinite(body.offset));
    const Eigen::Matrix3d R = body.T_parent_joint.linear();
    PDOIK_PROPERTY((R.transpose() * R).isIdentity(1e-9) && R.determinant() > 0.0, "body " << b
                                                                                          << "\n"
                                                                                          << R);
  }
  const Eigen::VectorXd q = robot.mid_configuration();
  for (const int tip : robot.tips()) {
    (void)robot.fk(q, tip);
    (void)robot.jacobian(q, tip);
  }
  (void)robot.total_mass();
}

void from_other_links(const RobotDescription& description) {
  std::string world = "w";  // longer than any name there is
  for (const LinkDescription& link : description.links) world += link.name;
  for (const JointDescription& joint : description.joints) world += joint.name;
  for (const LinkDescription& base : {description.links.front(), description.links.back()}) {
    const std::string tip = description.links.front().name;
    check_robot(Robot(description, base.name, {tip}));
    check_robot(Robot(mounted(description, base.name, Eigen::Isometry3d::Identity(), world)));
  }
}

}  // namespace
}  // namespace pdoik

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  // Text that is none is a path: those of this machine are nothing to read here.
  if (text.find_first_of("<\n") == std::string::npos) return 0;
  pdoik::RobotDescription description;
  try {
    description = pdoik::load_urdf(text);
    pdoik::check_robot(pdoik::Robot(description));
  } catch (const pdoik::LoadError& error) {
    PDOIK_PROPERTY(*error.what() != 0);
    return 0;
  }
  pdoik::from_other_links(description);  // what can be built can be built from any link
  return 0;
}
