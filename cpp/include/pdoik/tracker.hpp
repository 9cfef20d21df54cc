#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <span>
#include <string>

#include "pdoik/latency_histogram.hpp"
#include "pdoik/solver.hpp"

namespace pdoik {

/// Of a tracker. Metres, radians, seconds.
struct TrackerOptions {
  double period = 0.001;  ///< between steps [s]
  /// Hard deadline of a step [s]; 0 for 0.8 of the period.
  double max_time = 0.0;
  double speed_share = 1.0;  ///< of the robot's speed limits that may be used
  /// Speed limits to hold besides those of the robot, shape (n,) [rad/s] or [m/s]; empty for none.
  Eigen::VectorXd max_speed = {};
  /// How much joint speeds may change in a second, shape (n,) [rad/s^2] or [m/s^2]; empty for as
  /// much as they like. Joints then speed up and brake before goals, limits and obstacles.
  Eigen::VectorXd max_acceleration = {};
  /// Of the squared distance to the posture, where one is set [m^2/rad^2].
  double posture_weight = 1e-3;
  /// Of the squared distance to the last answer, in what the search is pulled to [m^2/rad^2].
  double smoothness = 1e-4;
};

/// What became of a step.
enum class TrackerStatus {
  Tracking,        ///< goals, limits and all constraints hold to their tolerances
  Infeasible,      ///< they cannot be met within the step, as far as going downhill shows; q is the
                   ///< step that comes nearest, and result.worst names what gives
  DeadlineStruck,  ///< max_time struck before they were met; q is the best so far, which is at
                   ///< worst the last answer
  InvalidInput,  ///< the goals or the last obstacles make no sense, or there are obstacles and the
                 ///< robot has no hulls: `complaint` says why; q is the last answer
};

/// A status in lower case with underscores, as the Python module gives it.
const char* to_string(TrackerStatus status);

/// The outcome of a step. Clearance beyond 0.5 m is reported as that much: a step has no time to
/// find out how far the far is. Whatever the status, q is never farther from the last answer than
/// the step limits, and by the scene as it is no deeper in anything than standing still would be,
/// nor than contact: points, shapes, the robot itself, what is attached to it, the balance it is
/// asked to keep.
struct TrackerResult : Result {
  TrackerStatus tracking = TrackerStatus::InvalidInput;  ///< what became of the step
  int step_limited = -1;  ///< the first joint that its step limit holds back, -1 for none
  /// Whether it stops harder than `max_acceleration` allows: braking only so hard would be deeper
  /// in something or leave the limits of a joint, or the input was refused.
  bool stopped_hard = false;
  /// Why the input was refused; empty otherwise. It points to text that lives until the next step.
  const char* complaint = "";
};

/// How fast obstacles move, one row for all of them or one for each, shape (1, 3) or (N, 3) [m/s].
using ObstacleVelocity = Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>,
                                    0, Eigen::OuterStride<>>;

/// Inverse kinematics as a control loop wants it: one step each period, from the last answer, by a
/// deadline.
///
///     pdoik::Tracker tracker(robot, options, {.period = 0.001});
///     tracker.reset(q_measured);
///     while (running) {
///       if (new_cloud) tracker.set_obstacles(points);
///       send(tracker.step(goals).q);
///     }
///
/// Every step begins with standing still. What comes nearest to the goals inside a box of speed
/// limits times period, the joint limits and barriers takes its place: of what is clear a step
/// takes half the room at most, and what is touched is left first. It is taken only if it is judged
/// to be no deeper in anything than standing still, nor than contact, all along the straight way,
/// and nearer to the goals, or clearer. Where acceleration is limited the same is asked of where it
/// would come to rest, so that it can brake before what stands still; if something comes too near
/// for that it stops at once, and the step says so. On the way what could be grazed unseen is less
/// than a tenth of a millimetre. A goal that cannot be reached is come near to, and the robot
/// rests. There are no restarts, so it cannot jump, and a minimum that is only local may hold it.
/// Input that makes no sense does not throw: the last answer stands, and the step says so. A
/// tracker belongs to one thread; after construction nothing allocates, locks or prints.
class Tracker {
 public:
  /// @name Making one
  /// @{

  /// A tracker for a robot as it is now, at the middle of its ranges. All memory is taken here.
  /// @param solver_options  Goals' type, tolerances, clearance, balance and self-collision count;
  /// the budget of a solve does not. `max_obstacles` is the largest cloud that is taken.
  /// @throws std::invalid_argument as Solver's constructor does, naming the option out of range.
  explicit Tracker(const Robot& robot, const Options& solver_options = {},
                   const TrackerOptions& options = {});
  Tracker(Tracker&&) noexcept;             ///< moved, not copied
  Tracker& operator=(Tracker&&) noexcept;  ///< moved, not copied
  ~Tracker();                              ///< frees what it holds

  /// As it was at construction.
  const Robot& robot() const;
  /// Those it was made with.
  const Options& solver_options() const;
  /// Those it was made with.
  const TrackerOptions& options() const;
  /// @}

  /// @name Where it is
  /// @{

  /// Where the next step starts from, shape (n,): the measured configuration, most often. Moved
  /// inside the limits.
  /// @param velocity  How fast it moves, which counts where acceleration is limited; empty for at
  /// rest. Shape (n,) [rad/s] or [m/s].
  /// @throws std::invalid_argument on a wrong length, NaN or infinity.
  void reset(VectorIn q, VectorIn velocity = Eigen::VectorXd());
  /// The last answer, shape (n,); mid-range before the first reset.
  const Eigen::VectorXd& q() const;
  /// Its speed in the last step where acceleration is limited, shape (n,); 0 else.
  const Eigen::VectorXd& velocity() const;

  /// A posture to stay near from now on, shape (n,); empty for none.
  /// @throws std::invalid_argument on a wrong length, NaN or infinity.
  void set_posture(VectorIn posture);
  /// @}

  /// @name Obstacles and what is attached to it
  /// @{

  /// The obstacles from now on, as Solver::set_obstacles takes them. NaN, infinity, a wrong shape
  /// or more rows than max_obstacles: the cloud before stays, and steps say InvalidInput until a
  /// good one comes.
  /// @returns Whether it was taken.
  bool set_obstacles(const Obstacles& points);
  /// The same of points that move: they are kept off where they are, and where they will be when
  /// the next step ends. Those that move count twice in max_obstacles. Allocates when there are
  /// more of them than ever before.
  bool set_obstacles(const Obstacles& points, const ObstacleVelocity& velocity);
  /// Those of a cloud, as they are whenever a step begins. A step waits for no update; it allocates
  /// when the cloud has become larger than max_obstacles.
  void set_obstacles(const Cloud& cloud);
  /// The solids from now on, beside the points; Shapes() for none. Allocates.
  /// @throws std::invalid_argument  A rule of contact speaks of what is neither a link, nor a
  /// shape, nor attached now, and is not optional; or it gives points a negative clearance, and the
  /// method or the inner one is not the default.
  void set_shapes(const Shapes& shapes);
  /// The same of solids that move, as of points; a result calls them `name (ahead)` where they will
  /// be. Allocates.
  /// @throws std::invalid_argument  As above; a velocity that is not finite, or of neither one row
  /// nor one for each.
  void set_shapes(const Shapes& shapes, const ObstacleVelocity& velocity);
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

  /// What set_obstacles does with a cloud that makes no sense, for one that is refused outside.
  void refuse_obstacles(const std::string& error);
  /// @}

  /// @name Stepping
  /// @{

  /// One step towards the goals. Throws nothing. The result is the tracker's own, until the next
  /// step.
  const TrackerResult& step(std::span<const Goal> goals);
  /// The same for a robot with one tip, whose goal is of the options' type.
  const TrackerResult& step(const Eigen::Isometry3d& T_base_tip);

  /// What a step does with input that makes no sense: the last answer once more, and why.
  const TrackerResult& hold(const std::string& error);

  /// How long steps took, all so far.
  const LatencyHistogram& latency() const;
  /// Count them anew.
  void clear_latency();
  /// The worst constraint of a result by name, see Solver::describe.
  std::string describe(const WorstConstraint& worst) const;
  /// @}

 private:
  struct Implementation;
  std::unique_ptr<Implementation> impl_;
};

}  // namespace pdoik
