#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pdoik/goal.hpp"
#include "pdoik/options.hpp"
#include "pdoik/result.hpp"
#include "pdoik/robot.hpp"
#include "pdoik/shapes.hpp"

namespace pdoik {

/// Obstacle points, one row each: x y z, or x y z radius, in the base frame [m]. Row-major views of
/// existing arrays are read without a conversion, once: what is checked and used is a copy.
using Obstacles =
    Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 0,
               Eigen::OuterStride<>>;

class Cloud;

/// What one solve is asked. All is read where the caller keeps it.
struct Request {
  std::span<const Goal> goals = {};  ///< at most one a tip; tips without one are free
  /// Where to start, shape (n,), moved inside the limits; answers near it are preferred. Null for
  /// the middle of the ranges (Method::Paper: omega = 0), and any answer.
  const Eigen::VectorXd* q0 = nullptr;
  /// A posture, shape (n,), that the answer comes as near to as goals and constraints let it, by
  /// going downhill from the first solution found. Null for none.
  const Eigen::VectorXd* posture = nullptr;
  /// Hard bounds on |q - q0| of each joint, shape (n,), not negative [rad] or [m]: speed times
  /// period, for a step that a machine can make. Null for none. Needs q0.
  const Eigen::VectorXd* max_step = nullptr;
};

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
/// starts. It looks at the clock before every evaluation and before every pass over the obstacles;
/// once max_time has struck, all that is left is the verdict on the best configuration, one pass
/// over the obstacles near the robot, for which it strikes early by what the last ones took.
class Solver {
 public:
  /// @name Making one
  /// @{

  /// A solver for a robot as it is now. All memory is taken here.
  /// @throws std::invalid_argument naming the option out of range; or if the robot has no joints or
  /// more than 64.
  explicit Solver(const Robot& robot, const Options& options = {});
  Solver(Solver&&) noexcept;             ///< moved
  Solver& operator=(Solver&&) noexcept;  ///< moved
  /// With the other's obstacles, which they share, and what it carries. Allocates.
  Solver(const Solver& other);
  ~Solver();  ///< frees what it holds

  /// As it was at construction.
  const Robot& robot() const;
  /// Those it was made with, as Options::sized_for has them.
  const Options& options() const;
  /// @}

  /// @name Obstacles and what the robot carries
  /// @{

  /// The obstacles of the solves that follow; empty for none. Allocates only when there are more
  /// points than ever before, options.max_obstacles to begin with, or when a copy of this solver
  /// still has the last ones: copies share them. What it took is in the results that follow, as
  /// `intake`.
  /// @throws std::invalid_argument on a wrong shape, NaN or infinity, a negative radius or a number
  /// beyond 1e6, naming the row, and on more than Cloud::kMostPoints.
  void set_obstacles(const Obstacles& points);
  /// Those of a cloud, as they are whenever a solve begins. Solvers share it.
  void set_obstacles(const Cloud& cloud);
  /// The solids of the solves that follow, beside the points; Shapes() for none. Allocates.
  /// @throws std::invalid_argument  Contact is allowed with a link that the robot does not have.
  void set_shapes(const Shapes& shapes);
  /// Let a link carry solids from now on, beside what links carry already: they keep off points,
  /// shapes and the robot's other links as its own hulls do. Allocates.
  /// @param shapes  Their poses are in the link's frame.
  /// @param may_touch  Links of the robot, shapes of scenes and other things that links carry, by
  /// name, that they may touch.
  /// @throws std::invalid_argument  There is no such link or no joint moves it; as check_shape; a
  /// half-space; a name that something carried has already.
  void attach(const std::string& link, std::span<const Shape> shapes,
              std::span<const std::string> may_touch = {});
  /// Let a link carry nothing any more.
  void detach(const std::string& link);
  /// Let no link carry anything any more.
  void detach();

  /// Neither points nor solids.
  void clear_obstacles();
  /// @}

  /// @name Solving
  /// @{

  /// Ask `wanted` about ten times a second whether to end a solve early, with the status TimeLimit:
  /// for Ctrl-C where max_time is long. It is asked by the thread that called alone, and ends a
  /// batch as well, of which the targets that were not begun keep that status and the middle of the
  /// ranges. Copies of the solver do not ask.
  void set_interrupt(std::function<bool()> wanted);

  /// Find q so that each goal's tip has its pose, axis or position, inside joint limits, clear of
  /// obstacles, balanced and off itself where the options say so. The real-time form: result.q is
  /// resized at the first use only.
  /// @throws std::invalid_argument on NaN, infinity, a target that is not rigid to 1e-6, a wrong
  /// length, a tip that there is not or that has two goals, a negative slack or weight, no goal;
  /// and, as everything here that looks at obstacles, where there are any, or the robot carries
  /// something, and it has no hulls: see Options::ignore_obstacles_without_hulls.
  void solve(const Request& request, Result& result);

  /// The same for a robot with one tip, whose goal is of the options' type.
  /// @param q0  As in Request.
  /// @throws std::invalid_argument additionally if the robot has several tips.
  Result solve(const Eigen::Isometry3d& T_base_tip,
               const std::optional<Eigen::VectorXd>& q0 = std::nullopt);
  /// The same in the real-time form.
  /// @param q0  May be null.
  void solve(const Eigen::Isometry3d& T_base_tip, const Eigen::VectorXd* q0, Result& result);

  /// Solve many targets among the same obstacles on several threads; the same answers on any number
  /// of them.
  /// @param q0  Empty, one start for all, or one each.
  /// @param threads  0 for one per processor.
  std::vector<Result> solve_batch(std::span<const Eigen::Isometry3d> targets,
                                  std::span<const Eigen::VectorXd> q0 = {}, int threads = 0) const;

  /// The same with goals for each: `goals[i]` for the i-th solve.
  std::vector<Result> solve_goals_batch(std::span<const std::vector<Goal>> goals,
                                        std::span<const Eigen::VectorXd> q0 = {},
                                        int threads = 0) const;
  /// @}

  /// @name Judging
  /// @{

  /// Errors, clearance, limits and verdict of a configuration, recomputed from q by plain forward
  /// kinematics. It uses the solver's own memory, as `solve` does.
  void judge(const Eigen::Isometry3d& T_base_tip, VectorIn q, Result& result);
  /// The same for several goals.
  void judge(std::span<const Goal> goals, VectorIn q, Result& result);

  /// The goal of the options' type for the tip, or for one of several.
  Goal goal(const Eigen::Isometry3d& T_base_tip, int tip = 0) const;

  /// The distance of each shape, and of the points if there are any, at a configuration: the least
  /// of them is the clearance that judge gives, but for what Options::touch lets touch, which
  /// depends on the target. Allocates.
  /// @throws std::invalid_argument on a wrong length, NaN or infinity.
  std::vector<ObstacleClearance> clearances(VectorIn q);

  /// "clearance of panda_link5, spheroid 12, to obstacle 17", for people.
  std::string describe(const WorstConstraint& worst) const;
  /// "panda_link5 (capsule 12)" or what is carried, of the nearest part; empty for none.
  std::string part_name(const ObstacleClearance& of) const;
  /// A shape's name by its place.
  std::string shape_name(int shape) const;
  /// @}

 private:
  struct Implementation;
  std::unique_ptr<Implementation> impl_;
};

}  // namespace pdoik
