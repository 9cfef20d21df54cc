// A Levenberg-Marquardt method on Pinocchio's kinematics that stays inside the limits, with random
// restarts.
#include <Eigen/Cholesky>
#include <algorithm>
#include <exception>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/parsers/urdf.hpp>
#include <stdexcept>
#include <string>

#include "restarts.hpp"

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Chosen by hand on the targets of bench/compare.py, for the best median and 95th percentile of
// three arms.
constexpr double kRotationWeight = 0.3;   // metres that one radian weighs [m]
constexpr double kFirstDamping = 0.3;     // lambda, of the mean diagonal entry of J J^T
constexpr double kDampingDecrease = 0.2;  // after a step that reduced the error
constexpr double kDampingIncrease = 4.0;  // after one that did not
constexpr int kMaxIterations = 40;        // of one attempt
constexpr double kStallRatio = 0.9;       // an attempt ends when each of the last kStallSteps steps
constexpr int kStallSteps = 3;            // left more of the error's norm than this

}  // namespace

struct Peer {
  explicit Peer(const PeerSetup& setup)
      : position_tolerance(setup.position_tolerance),
        rotation_tolerance(setup.rotation_tolerance),
        model(read(setup.urdf_path)),
        data(model),
        tip(model.getFrameId(setup.tip_link)),
        restarts(model.lowerPositionLimit, model.upperPositionLimit, setup.max_time) {
    if (setup.axis_goal != 0) throw std::invalid_argument("this peer knows whole poses only");
    if (tip >= static_cast<pinocchio::FrameIndex>(model.nframes)) {
      throw std::invalid_argument(std::string("no link ") + setup.tip_link);
    }
    J.setZero(6, model.nv);
    step.setZero(model.nv);
    trial.setZero(model.nq);
  }

  static pinocchio::Model read(const std::string& urdf) {
    pinocchio::Model model;
    pinocchio::urdf::buildModel(urdf, model);
    return model;
  }

  /// The tip's weighted error in its own frame: how far the target is, and the rotation vector to
  /// it.
  Vector6 error(const Eigen::VectorXd& q, const pinocchio::SE3& target) {
    pinocchio::forwardKinematics(model, data, q);
    const pinocchio::SE3 gap = pinocchio::updateFramePlacement(model, data, tip).actInv(target);
    Vector6 e;
    e << gap.translation(), kRotationWeight * pinocchio::log3(gap.rotation());
    return e;
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
    step.noalias() = J.transpose() * e;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const bool held =
          step[i] > 0.0 ? q[i] >= model.upperPositionLimit[i] : q[i] <= model.lowerPositionLimit[i];
      if (held) J.col(i).setZero();
    }
    JJt.noalias() = J * J.transpose();
  }

  /// Minimise |e|^2 from q by steps J^T (J J^T + lambda I)^-1 e, clamped to the limits.
  bool attempt(const pinocchio::SE3& target, Eigen::VectorXd& q,
               const pdoik::bench::Stopwatch& watch, int& iterations) {
    Vector6 e = error(q, target);
    linearise(q, e);
    double lambda = kFirstDamping * JJt.trace() / 6.0;
    int stalled = 0;
    for (int k = 0; k < kMaxIterations && stalled < kStallSteps && !watch.expired(); ++k) {
      if (solves(e)) return true;
      ++iterations;
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

  double position_tolerance, rotation_tolerance;
  pinocchio::Model model;
  pinocchio::Data data;
  pinocchio::FrameIndex tip;
  pdoik::bench::Restarts restarts;
  Eigen::Matrix<double, 6, Eigen::Dynamic> J;
  Matrix6 JJt;
  Eigen::VectorXd step, trial;
};

static std::string last_error;

Peer* peer_create(const PeerSetup* setup) try {
  return new Peer(*setup);
} catch (const std::exception& error) {
  last_error = error.what();
  return nullptr;
}

void peer_destroy(Peer* peer) { delete peer; }

const char* peer_error() { return last_error.c_str(); }

int peer_solve(Peer* peer, const PeerProblem* problem, PeerAnswer* answer) {
  using pdoik::bench::Stopwatch;
  if (problem->obstacle_count > 0) return -1;
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> T(problem->T_base_tip);
  const pinocchio::SE3 target(T.topLeftCorner<3, 3>(), T.topRightCorner<3, 1>());
  peer->restarts.run(*problem, *answer,
                     [&](Eigen::VectorXd& q, const Stopwatch& watch, int& iterations) {
                       return peer->attempt(target, q, watch, iterations);
                     });
  return 0;
}
