#include "plain_problem.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace pdoik::testing {
namespace {

double sigmoid(double omega) { return 1.0 / (1.0 + std::exp(-omega)); }  // Eq. sigmoid

void check_serial(const Robot& robot) {
  const auto& bodies = robot.bodies();
  if (robot.body_of_link(robot.tips().front()) != static_cast<int>(bodies.size()) - 1) {
    throw std::invalid_argument("the tip " + robot.tip_links().front() +
                                " is not on the last body");
  }
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    const bool serial =
        bodies[b].parent == static_cast<int>(b) - 1 && bodies[b].dof == static_cast<int>(b) - 1;
    const bool plain =
        !bodies[b].prismatic && bodies[b].multiplier == 1.0 && bodies[b].offset == 0.0;
    const Eigen::Index i = bodies[b].dof;
    if (!serial || !plain || !std::isfinite(robot.upper()[i] - robot.lower()[i])) {
      throw std::invalid_argument("joint " + robot.joint_names()[static_cast<std::size_t>(i)] +
                                  ": expected a serial chain of revolute joints with limits");
    }
  }
}

}  // namespace

PlainProblem::PlainProblem(const Robot& robot, const Options& options)
    : lower_(robot.lower()),
      goal_(options.goal),
      goal_axis_(options.goal_axis.normalized()),
      clearance_(options.clearance) {
  check_serial(robot);
  last_frame_ = {0};
  for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
    const int joint = robot.bodies()[b].dof;
    const double range = robot.upper()[joint] - lower_[joint];
    const int K = std::max(1, static_cast<int>(std::ceil(range / M_PI - 1e-9)));
    Eigen::Isometry3d fixed = robot.bodies()[b].T_parent_joint;
    fixed.rotate(Eigen::AngleAxisd(lower_[joint], Eigen::Vector3d::UnitZ()));
    for (int m = 0; m < K; ++m) {
      units_.push_back({joint, 1.0 - std::cos(std::min(range / K, M_PI)), fixed.matrix()});
      fixed.setIdentity();
    }
    last_frame_.push_back(static_cast<int>(units_.size()));
  }
  const int tip = robot.tips().front();
  T_last_tip_ = robot.T_body_link(tip).matrix();
  tip_points_.emplace_back(0.0, 0.0, 0.0, 1.0);  // u_e, then the w_ep and v_ep (Eq. vwep)
  const double k = options.sized_for(robot).point_distance;
  if (goal_ == GoalType::Pose) {
    tip_points_.emplace_back(k, 0.0, 0.0, 1.0);
    tip_points_.emplace_back(0.0, k, 0.0, 1.0);
  } else if (goal_ == GoalType::Axis) {
    tip_points_.emplace_back((k * goal_axis_).homogeneous());
  }
  add_hulls(robot);
  T_.assign(units_.size() + 1, Eigen::Matrix4d::Identity());
  T_step_ = dT_domega_ = dL_dT_ = T_;
  positions_.setZero(3, static_cast<Eigen::Index>(points_.size()));
}

int PlainProblem::attach(const Robot& robot, const std::string& link, const Eigen::Vector3d& xyz) {
  const int index = robot.link_index(link);
  const AttachedPoint point{last_frame_[static_cast<std::size_t>(robot.body_of_link(index))],
                            (robot.T_body_link(index) * xyz).homogeneous()};
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (points_[k].frame == point.frame && points_[k].local.isApprox(point.local, 1e-12))
      return static_cast<int>(k);
  }
  points_.push_back(point);
  return static_cast<int>(points_.size()) - 1;
}

void PlainProblem::add_hulls(const Robot& robot) {
  const auto add = [&](int a, int b, double semi_major) {
    const auto is_fixed = [&](int point) {
      return points_[static_cast<std::size_t>(point)].frame == 0;
    };
    if (!is_fixed(a) || !is_fixed(b))
      hulls_.push_back({a, b, semi_major});  // no joint moves the others
  };
  for (const Sphere& sphere : robot.occupancy().spheres) {
    const int at = attach(robot, sphere.link, sphere.center);
    add(at, at, sphere.radius);
  }
  for (const Spheroid& spheroid : robot.occupancy().spheroids) {
    const int a = attach(robot, spheroid.link_a, spheroid.focus_a);
    add(a, attach(robot, spheroid.link_b, spheroid.focus_b), spheroid.semi_major);
  }
}

void PlainProblem::set_obstacles(const Obstacles& points) {
  obstacles_ = points.leftCols<3>().transpose();
  distances_.setZero(static_cast<Eigen::Index>(points_.size()), points.rows());
  mu_.setZero(static_cast<Eigen::Index>(hulls_.size()), points.rows());
}

// Algorithm FWD, lines 1 to 7.
void PlainProblem::roll_out(const Eigen::VectorXd& omega) {
  for (std::size_t i = 1; i < T_.size(); ++i) {
    const Unit& unit = units_[i - 1];
    const double w = omega[static_cast<Eigen::Index>(i) - 1];
    const double s = sigmoid(w), complement = sigmoid(-w);
    const double L = unit.L_max * s;  // Eq. squash1
    const double rest = unit.L_max == 2.0 ? 2.0 * complement : 2.0 - L;
    const double cosine = 1.0 - L, sine = std::sqrt(L * rest);  // Eqs. cos2distance, sin2dist
    // dtheta/dL times dL/domega: the first is infinite at both ends, their product is not.
    const double slope =
        unit.L_max == 2.0 ? std::sqrt(s * complement) : std::sqrt(L / rest) * complement;
    Eigen::Matrix4d turn = Eigen::Matrix4d::Identity(), derivative = Eigen::Matrix4d::Zero();
    turn.topLeftCorner<2, 2>() << cosine, -sine, sine, cosine;
    derivative.topLeftCorner<2, 2>() << -sine, -cosine, cosine, -sine;
    T_step_[i] = unit.fixed * turn;                   // Eq. distanceDH_matrix
    dT_domega_[i] = unit.fixed * derivative * slope;  // Eqs. dDHddistsquare, ddistsquaredomega
    T_[i] = T_[i - 1] * T_step_[i];                   // Eq. DHchain
  }
  T_tip_ = T_.back() * T_last_tip_;
}

void PlainProblem::measure_distances() {
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const auto i = static_cast<Eigen::Index>(p);
    positions_.col(i) =
        (T_[static_cast<std::size_t>(points_[p].frame)] * points_[p].local).head<3>();
    for (Eigen::Index j = 0; j < obstacles_.cols(); ++j) {
      distances_(i, j) = (positions_.col(i) - obstacles_.col(j)).norm();
    }
  }
}

double PlainProblem::constraint(const Hull& hull, Eigen::Index obstacle) const {
  const double a = hull.semi_major + clearance_;
  if (hull.a == hull.b) return a - distances_(hull.a, obstacle);  // Eq. joint_coll_avoid
  return 2.0 * a -
         (distances_(hull.a, obstacle) + distances_(hull.b, obstacle));  // Eq. link_coll_avoid
}

// Algorithm FWD, lines 8 to 12, and Eq. dJdTe.
double PlainProblem::objective() {
  double J = 0.0;
  Eigen::Matrix4d dJ_dTe = Eigen::Matrix4d::Zero();
  for (const Eigen::Vector4d& local : tip_points_) {
    const Eigen::Vector4d error = T_tip_ * local - T_target_ * local;
    J += 0.5 * error.squaredNorm();
    dJ_dTe += error * local.transpose();
  }
  dL_dT_.back() += dJ_dTe * T_last_tip_.transpose();
  return J;
}

// Algorithm FWD, lines 13 to 18, and Algorithm Jacobian's first loop.
double PlainProblem::penalties(const Penalty& penalty) {
  double sum = 0.0;
  for (Eigen::Index j = 0; j < obstacles_.cols(); ++j) {
    for (std::size_t h = 0; h < hulls_.size(); ++h) {
      const Hull& hull = hulls_[h];
      const double c = constraint(hull, j);
      max_constraint_ = std::max(max_constraint_, c);
      const Penalty::Term term = penalty.term(c, mu_(static_cast<Eigen::Index>(h), j));
      if (term.slope == 0.0) continue;
      sum += term.value;
      push(hull.a, j, term.slope);
      if (hull.b != hull.a) push(hull.b, j, term.slope);
    }
  }
  return sum;
}

void PlainProblem::push(int point, Eigen::Index obstacle, double slope) {
  const double distance = distances_(point, obstacle);
  if (!(distance > 1e-12)) return;  // the guard of |u - o| = 0
  Eigen::Vector4d dL_du = Eigen::Vector4d::Zero();
  dL_du.head<3>() = -slope / distance * (positions_.col(point) - obstacles_.col(obstacle));
  const AttachedPoint& at = points_[static_cast<std::size_t>(point)];
  dL_dT_[static_cast<std::size_t>(at.frame)] += dL_du * at.local.transpose();
}

double PlainProblem::lagrangian(const Eigen::VectorXd& omega, const Penalty& penalty,
                                Eigen::VectorXd& gradient) {
  roll_out(omega);
  measure_distances();
  for (Eigen::Matrix4d& each : dL_dT_) each.setZero();
  max_constraint_ = 0.0;
  const double J = objective();
  const double value = J + penalties(penalty);
  for (std::size_t i = T_.size() - 1; i > 0; --i) {  // Algorithm Jacobian's second loop
    const Eigen::Matrix4d dL_dstep = T_[i - 1].transpose() * dL_dT_[i];  // Eq. dLdDH
    gradient[static_cast<Eigen::Index>(i) - 1] =
        dL_dstep.cwiseProduct(dT_domega_[i]).sum();       // Eq. dLdw
    dL_dT_[i - 1] += dL_dT_[i] * T_step_[i].transpose();  // Eq. dLdT
  }
  return value;
}

double PlainProblem::max_constraint(const Eigen::VectorXd& omega) {
  roll_out(omega);
  measure_distances();
  max_constraint_ = 0.0;
  for (Eigen::Index j = 0; j < obstacles_.cols(); ++j) {
    for (const Hull& hull : hulls_)
      max_constraint_ = std::max(max_constraint_, constraint(hull, j));
  }
  return max_constraint_;
}

void PlainProblem::update_multipliers(const Eigen::VectorXd& omega, const Penalty& penalty) {
  roll_out(omega);
  measure_distances();
  for (Eigen::Index j = 0; j < obstacles_.cols(); ++j) {
    for (std::size_t h = 0; h < hulls_.size(); ++h) {
      double& mu = mu_(static_cast<Eigen::Index>(h), j);
      mu = penalty.updated_multiplier(constraint(hulls_[h], j), mu);
    }
  }
}

double PlainProblem::position_error() const { return (T_tip_.col(3) - T_target_.col(3)).norm(); }

double PlainProblem::rotation_error() const {
  if (goal_ == GoalType::Position) return 0.0;
  const Eigen::Matrix3d is = T_tip_.topLeftCorner<3, 3>(), wanted = T_target_.topLeftCorner<3, 3>();
  if (goal_ == GoalType::Axis) {
    const Eigen::Vector3d a = is * goal_axis_, b = wanted * goal_axis_;
    return std::atan2(a.cross(b).norm(), a.dot(b));
  }
  const Eigen::Matrix3d R = wanted.transpose() * is;
  const Eigen::Vector3d twice_sine(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  return std::atan2(twice_sine.norm(), R.trace() - 1.0);
}

void PlainProblem::recover(const Eigen::VectorXd& omega, Eigen::VectorXd& q) const {
  q = lower_;
  for (std::size_t m = 0; m < units_.size(); ++m) {
    q[units_[m].joint] +=
        std::acos(1.0 - units_[m].L_max * sigmoid(omega[static_cast<Eigen::Index>(m)]));
  }
}

void PlainProblem::start_from(const Eigen::VectorXd& q, double inset,
                              Eigen::VectorXd& omega) const {
  for (std::size_t m = 0; m < units_.size(); ++m) {
    const Unit& unit = units_[m];
    const auto is_same = [&](const Unit& other) { return other.joint == unit.joint; };
    const auto K = static_cast<double>(std::count_if(units_.begin(), units_.end(), is_same));
    const double sub_range = std::acos(1.0 - unit.L_max);
    const double share = (q[unit.joint] - lower_[unit.joint]) / K;
    const double theta = std::clamp(share, inset * sub_range, (1.0 - inset) * sub_range);
    const double L = 1.0 - std::cos(theta);
    omega[static_cast<Eigen::Index>(m)] = std::log(L / (unit.L_max - L));
  }
}

}  // namespace pdoik::testing
