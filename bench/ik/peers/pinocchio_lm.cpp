// A Levenberg-Marquardt method on Pinocchio's kinematics that stays inside the limits, with random
// restarts. It knows no obstacles: an attempt counts when the hulls are clear of them where it
// ends.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/parsers/urdf.hpp>
#include <stdexcept>
#include <string>

#include "interface.hpp"
#include "obstacle_check.hpp"
#include "restarts.hpp"

namespace pdoik::bench {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Chosen by hand on the targets of bench/ik/compare/__main__.py, for the best median and 95th
// percentile of three arms.
constexpr double kRotationWeight = 0.3;   // metres that one radian counts as [m]
constexpr double kFirstDamping = 0.3;     // lambda, of the mean diagonal entry of J J^T
constexpr double kDampingDecrease = 0.2;  // after a step that reduced the error
constexpr double kDampingIncrease = 4.0;  // after one that did not
constexpr int kMaxIterations = 40;        // of one attempt
constexpr double kStallRatio = 0.9;       // an attempt ends when each of the last kStallSteps steps
constexpr int kStallSteps = 3;            // left more of the error's norm than this

class PinocchioLm : public Peer {
 public:
  explicit PinocchioLm(const PeerSetup& setup)
      : axis_goal(setup.axis_goal != 0),
        position_tolerance(setup.position_tolerance),
        rotation_tolerance(setup.rotation_tolerance),
        model(read(setup.urdf_path)),
        data(model),
        tip(frame_of(model, setup.tip_link)),
        check(setup.occupancy_yaml, [this](const std::string& link) { return carrier(link); }),
        restarts(model.lowerPositionLimit, model.upperPositionLimit, setup) {
    J.setZero(6, model.nv);
    step.setZero(model.nv);
    trial.setZero(model.nq);
  }

  bool solve(const PeerProblem& problem, PeerAnswer& answer) override {
    const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> T(problem.T_base_tip);
    const pinocchio::SE3 target(T.topLeftCorner<3, 3>(), T.topRightCorner<3, 1>());
    restarts.run(
        problem, answer, [&] { check.set_points(problem); },
        [&](Eigen::VectorXd& q, const Stopwatch& watch, PeerAnswer& count) {
          return attempt(target, q, watch, count) && is_clear();
        });
    return true;
  }

 private:
  static pinocchio::Model read(const std::string& urdf) {
    pinocchio::Model model;
    pinocchio::urdf::buildModel(urdf, model);
    return model;
  }

  static pinocchio::FrameIndex frame_of(const pinocchio::Model& model, const std::string& link) {
    if (!model.existFrame(link, pinocchio::BODY)) throw std::invalid_argument("no link " + link);
    return model.getFrameId(link, pinocchio::BODY);
  }

  ObstacleCheck::Carrier carrier(const std::string& link) const {
    const pinocchio::Frame& frame = model.frames[frame_of(model, link)];
    Eigen::Isometry3d T;
    T.matrix() = frame.placement.toHomogeneousMatrix();
    return {static_cast<int>(frame.parentJoint), T};
  }

  /// Of obstacles, where error() was last.
  bool is_clear() {
    return !check.touches([this](int joint, const Eigen::Vector3d& local) -> Eigen::Vector3d {
      return data.oMi[static_cast<std::size_t>(joint)].act(local);
    });
  }

  /// The tip's weighted error in its own frame: how far the target is, and the rotation vector to
  /// it, for axis goals to the direction of its z.
  Vector6 error(const Eigen::VectorXd& q, const pinocchio::SE3& target) {
    pinocchio::forwardKinematics(model, data, q);
    const pinocchio::SE3 gap = pinocchio::updateFramePlacement(model, data, tip).actInv(target);
    Vector6 e;
    e << gap.translation(), kRotationWeight * (axis_goal ? tilt(gap.rotation().col(2))
                                                         : pinocchio::log3(gap.rotation()));
    return e;
  }

  /// The shortest rotation vector from z to a direction: it has no part about z.
  static Eigen::Vector3d tilt(const Eigen::Vector3d& direction) {
    const double sine = std::hypot(direction.x(), direction.y());
    const double angle = std::atan2(sine, direction.z());
    if (sine == 0.0) return {angle, 0.0, 0.0};
    return {-angle / sine * direction.y(), angle / sine * direction.x(), 0.0};
  }

  bool solves(const Vector6& e) const {
    return e.head<3>().norm() < position_tolerance &&
           e.tail<3>().norm() < kRotationWeight * rotation_tolerance;
  }

  /// J of the weighted error at q, where error() was last; nothing for joints at a limit that it
  /// pushes against.
  void linearise(const Eigen::VectorXd& q, const Vector6& e) {
    pinocchio::computeJointJacobians(model, data);
    J.setZero();
    pinocchio::getFrameJacobian(model, data, tip, pinocchio::LOCAL, J);
    J.bottomRows<3>() *= kRotationWeight;
    if (axis_goal) J.row(5).setZero();  // turning about the tip's z is free
    step.noalias() = J.transpose() * e;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const bool held =
          step[i] > 0.0 ? q[i] >= model.upperPositionLimit[i] : q[i] <= model.lowerPositionLimit[i];
      if (held) J.col(i).setZero();
    }
    JJt.noalias() = J * J.transpose();
  }

  /// Minimise |e|^2 from q by steps J^T (J J^T + lambda I)^-1 e, clamped to the limits.
  /// Where it succeeds, error() was last at its answer.
  bool attempt(const pinocchio::SE3& target, Eigen::VectorXd& q, const Stopwatch& watch,
               PeerAnswer& count) {
    Vector6 e = error(q, target);
    ++count.evaluations;
    linearise(q, e);
    double lambda = kFirstDamping * JJt.trace() / 6.0;
    int stalled = 0;
    for (int k = 0; k < kMaxIterations && stalled < kStallSteps && !watch.expired(); ++k) {
      if (solves(e)) return true;
      ++count.iterations;
      ++count.evaluations;
      Matrix6 A = JJt;
      A.diagonal().array() += lambda;
      step.noalias() = J.transpose() * A.llt().solve(e);
      trial = (q + step).cwiseMax(model.lowerPositionLimit).cwiseMin(model.upperPositionLimit);
      const Vector6 e_trial = error(trial, target);
      stalled = e_trial.norm() > kStallRatio * e.norm() ? stalled + 1 : 0;
      if (e_trial.norm() < e.norm()) {
        q.swap(trial);
        e = e_trial;
        lambda *= kDampingDecrease;
        if (!solves(e)) linearise(q, e);
      } else {
        lambda *= kDampingIncrease;
      }
    }
    return solves(e);
  }

  bool axis_goal;
  double position_tolerance, rotation_tolerance;
  pinocchio::Model model;
  pinocchio::Data data;
  pinocchio::FrameIndex tip;
  ObstacleCheck check;
  Restarts restarts;
  Eigen::Matrix<double, 6, Eigen::Dynamic> J;
  Matrix6 JJt;
  Eigen::VectorXd step, trial;
};

}  // namespace

std::unique_ptr<Peer> make_peer(const PeerSetup& setup) {
  return std::make_unique<PinocchioLm>(setup);
}

}  // namespace pdoik::bench
