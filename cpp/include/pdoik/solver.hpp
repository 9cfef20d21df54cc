#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pdoik/options.hpp"
#include "pdoik/result.hpp"
#include "pdoik/robot.hpp"

namespace pdoik {

/// Obstacle points, one row each: x y z, or x y z radius, in the base frame [m]. Row-major views of
/// existing arrays are read in place.
using Obstacles =
    Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 0,
               Eigen::OuterStride<>>;

/// Constrained inverse kinematics among points (Sec. algorithm).
///
///     pdoik::Robot robot = pdoik::Robot::builtin("panda");
///     pdoik::Solver solver(robot);
///     solver.set_obstacles(points);
///     pdoik::Result result;
///     solver.solve(T_base_tip, &q0, result);
///
/// A solver belongs to one thread. After set-up (construction, set_obstacles, a result sized once)
/// `solve` allocates nothing, takes no lock, prints nothing and throws only on misuse, before it
/// starts.
class Solver {
 public:
  /// @throws std::invalid_argument naming the option out of range; or if the robot has several
  /// tips.
  explicit Solver(const Robot& robot, const Options& options = {});
  Solver(Solver&&) noexcept;
  Solver& operator=(Solver&&) noexcept;
  Solver(const Solver& other);
  ~Solver();

  const Robot& robot() const;
  const Options& options() const;

  /// The obstacles of the solves that follow; empty for none.
  /// @throws std::invalid_argument on a wrong shape, NaN or infinity, a negative radius or a number
  /// beyond 1e6, naming the row. Allocates only when there are more points than ever before,
  /// options.max_obstacles to begin with.
  void set_obstacles(const Obstacles& points);
  void clear_obstacles();

  /// Ask `wanted` about ten times a second whether to end a solve early, with the status TimeLimit:
  /// for Ctrl-C where max_time is long. Copies of the solver do not ask.
  void set_interrupt(std::function<bool()> wanted);

  /// Find q so that the tip has the goal's pose, axis or position, inside joint limits, clear of
  /// obstacles.
  /// @param T_base_tip  The target, rigid to 1e-6.
  /// @param q0  Where to start, shape (n,), moved inside the limits; answers near it are preferred.
  ///     None for the middle of the ranges (Method::Paper: omega = 0), and any answer.
  /// @throws std::invalid_argument on NaN, infinity, a target that is not rigid, a wrong length.
  Result solve(const Eigen::Isometry3d& T_base_tip,
               const std::optional<Eigen::VectorXd>& q0 = std::nullopt);
  /// The same into a result whose q is resized at the first use only: the real-time form.
  /// @param q0  May be null.
  void solve(const Eigen::Isometry3d& T_base_tip, const Eigen::VectorXd* q0, Result& result);

  /// Solve many targets among the same obstacles on several threads; the same answers on any number
  /// of them.
  /// @param q0  Empty, one start for all, or one each.
  /// @param threads  0 for one per processor.
  std::vector<Result> solve_batch(std::span<const Eigen::Isometry3d> targets,
                                  std::span<const Eigen::VectorXd> q0 = {}, int threads = 0) const;

  /// Errors, clearance, limits and verdict of a configuration, recomputed from q by plain forward
  /// kinematics.
  void judge(const Eigen::Isometry3d& T_base_tip, VectorIn q, Result& result) const;

  /// "clearance of panda_link5, spheroid 12, to obstacle 17", for people.
  std::string describe(const WorstConstraint& worst) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> impl_;
};

}  // namespace pdoik
