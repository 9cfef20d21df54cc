#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pdoik/attachment.hpp"
#include "pdoik/goal.hpp"
#include "pdoik/options.hpp"
#include "pdoik/path.hpp"
#include "pdoik/request.hpp"
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

/// Which solutions are wanted of all that there are.
struct AllOptions {
  int limit = 0;  ///< no more than this many; 0 for all, of robots with finitely many
  /// Two differ if a joint does by more than this [rad] or [m]; 0 for 0.001 where all are known in
  /// closed form and 0.1 else.
  double distinct = 0.0;
};

/// Solutions of one request, none twice.
struct Solutions {
  std::vector<Result> results;  ///< nearest to the start, or to the posture, first
  /// In how many ways each can be turned by whole turns of joints inside their limits: 1 if not.
  std::vector<int> turns;
  /// Whether it is known that there are no others: of six joints whose geometry is solved in
  /// closed form.
  bool complete = false;
  /// How likely it is that one more start that meets the goals comes to what was found already:
  /// 1 less the share of starts whose end was met once (Good and Turing's estimate).
  double coverage = 0.0;
  Status status = Status::Exhausted;  ///< Solved if there are any, else why not
  int restarts = 0;                   ///< starts beyond the first
  double time = 0.0;                  ///< [s]
};

/// How an answer follows its targets.
struct Derivatives {
  /// Of q by each hard goal's target, 6 columns a goal: the target's shift and turn along the base
  /// frame's axes, shape (n, 6 * goals) [rad or m, by m or rad]. Joints at their limits, locked
  /// ones and contact stay as they are; of all that remains the least motion.
  Eigen::MatrixXd dq_dT;
  double manipulability = 0.0;  ///< product of the singular values of the goals' Jacobian
  /// The least singular value of it, its turns in metres by Options::rotation_weight: how far from
  /// a singularity [m].
  double singular_distance = 0.0;
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
  /// With the other's obstacles, which they share, and what is attached to it. Allocates.
  Solver(const Solver& other);
  ~Solver();  ///< frees what it holds

  /// As it was at construction.
  const Robot& robot() const;
  /// Those it was made with, as Options::sized_for has them.
  const Options& options() const;
  /// @}

  /// @name Obstacles and what is attached to it
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
  /// @throws std::invalid_argument  A rule of contact speaks of what is neither a link, nor a
  /// shape, nor attached now, and is not optional; or it gives points a negative clearance, and the
  /// method or the inner one is not the default.
  void set_shapes(const Shapes& shapes);
  /// Attach solids to links from now on, with what is attached already: they keep off points,
  /// shapes, the robot's other links and what is attached to these as its own hulls do. All, or
  /// none if any cannot be attached. Allocates.
  /// @throws std::invalid_argument  There is no such link, or no joint moves it; as check_shape and
  /// check_contact_rule; a half-space, a mesh, several boxes; a name that something attached has
  /// already.
  void attach(std::span<const Attachment> things);
  /// The same of one link.
  /// @param shapes  Their poses are in the link's frame.
  /// @param may_touch  Links of the robot, shapes of scenes, other things that are attached and the
  /// points, by name or pattern as in a ContactRule, that they may touch.
  void attach(const std::string& link, std::span<const Shape> shapes,
              std::span<const std::string> may_touch = {});
  /// What is attached to links, as it was given.
  std::vector<Attachment> attached() const;
  /// Detach all from a link: what is attached to another one too stays with that. Or detach an
  /// object, by its name.
  /// @throws std::invalid_argument  There is neither a link nor anything attached of this name.
  void detach(const std::string& name);
  /// Detach all from all links.
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
  /// resized at the first use only, and room made for as many alternatives as ever.
  /// @throws std::invalid_argument on NaN, infinity, a target that is not rigid to 1e-6, a wrong
  /// length, a tip that there is not, goals that contradict one another, a negative slack or
  /// weight, no goal, a lock outside limits; and, as everything here that looks at obstacles, where
  /// there are any, or something is attached to the robot, and it has no hulls: see
  /// Options::ignore_obstacles_without_hulls.
  void solve(const Request& request, Result& result);

  /// The distinct solutions of a request: of an arm of six joints whose geometry allows it all
  /// there are, by closed form; else those that starts find until a limit, max_time, or until
  /// nothing new comes. Allocates.
  /// @throws std::invalid_argument as `solve`; any_of; Method::Paper.
  Solutions solve_all(const Request& request, const AllOptions& wanted = {});

  /// A whole path as one question: joint positions that meet all stations one after the other and
  /// the straight way between them, clear of everything all along, in one motion; the shortest
  /// that is found. Where there is none: where it breaks and why, and as few motions as meet it,
  /// with clear moves from one to the next. Solutions of stations, all of them where they are known
  /// in closed form, are nodes of a graph in layers, which is searched for the best route; what
  /// lies between two nodes is followed until it is as exact as the stations. Allocates.
  /// @throws std::invalid_argument  As `solve` of a station, named by its number; fewer than two
  /// stations; two that ask different kinds of things, or are the same one after the other; a soft
  /// goal; a start or end of a wrong length, or outside limits, or that does not meet its station;
  /// an option out of range; other methods than the default one.
  PathResult solve_path(const PathRequest& request, const PathOptions& options = {});

  /// A move from a configuration to another, or to any of some goals, that is clear of everything
  /// all along: points, shapes, the robot itself, with what is attached to it. Allocates.
  /// @throws std::invalid_argument  As `solve`; no start; neither a configuration to end at nor
  /// goals, or both; an option out of range; other methods than the default one.
  MotionResult plan_motion(const MotionRequest& request, const MotionOptions& options = {});

  /// How a solution follows its targets: of q as it is, whether or not it solves. Allocates.
  /// @throws std::invalid_argument as `judge`.
  Derivatives derivatives(std::span<const Goal> goals, VectorIn q);

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
  /// The same of whole requests.
  std::vector<Result> solve_requests(std::span<const Request> requests, int threads = 0) const;
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

  /// How it went and by how much it fell short, for people: "panda_hand is 0.12 mm off its target,
  /// tolerance 0.01 mm", "goal 3 of 8: the target of panda_hand lies 12 mm farther away than its
  /// links stretch". Alternatives are counted from 1 here.
  std::string explain(const Request& request, const Result& result) const;
  /// The same of a path: where it breaks, and why.
  std::string explain(const PathRequest& request, const PathResult& result) const;
  /// What ends a motion along a path: a limit, a contact, a singularity.
  std::string explain(const PathEnd& end) const;
  /// "clearance of panda_link5, spheroid 12, to obstacle 17", for people.
  std::string describe(const WorstConstraint& worst) const;
  /// "panda_link5 (capsule 12)" or what is attached, of the nearest part; empty for none.
  std::string part_name(const ObstacleClearance& of) const;
  /// A shape's name by its place.
  std::string shape_name(int shape) const;
  /// @}

 private:
  struct Implementation;
  std::unique_ptr<Implementation> impl_;
};

}  // namespace pdoik
