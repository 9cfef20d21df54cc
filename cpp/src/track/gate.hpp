#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

#include "search/workspace.hpp"
#include "track/braking.hpp"

namespace pdoik::detail {

/// What a step of a control loop is asked.
struct StepRequest {
  std::span<const Goal> goals;
  const Eigen::VectorXd *from, *lower, *upper;  ///< the last answer, and where a step may lead
  const Eigen::VectorXd *pull_to, *pull;        ///< see PosturePull: what the search is pulled to
  const Eigen::VectorXd *posture, *weights;     ///< what is better beside the goals; may be null
  double max_time;                              ///< [s]
  /// Obstacles farther than this from the hulls cannot be met within a step; may be infinite [m].
  double margin;
  double advance, turn;  ///< how far a tip may be asked to go in one step [m], [rad]
  double look;           ///< clearance beyond this is reported as this [m]
  Braking* braking;      ///< how a step ends that leads somewhere
};

/// Guards what goes to the motors: the incumbent, which is to stand still at first, or to brake if
/// the robot moves and braking is no deeper. A candidate takes its place only if it is no deeper in
/// anything than standing still, nor than contact, all along the straight way to its end and from
/// there to rest, and leads to something better. Whenever the clock strikes, the incumbent goes
/// out.
class Gate {
 public:
  /// The workspace outlives it.
  explicit Gate(Workspace& workspace);

  /// Begin a step: judge standing still, and braking.
  void open(const StepRequest& step);
  /// How much of the way to a configuration there is time to look at, 1 for all of it.
  double share_in_time(const Eigen::VectorXd& q);
  /// Take the step that leads a share of the way to a configuration as the incumbent.
  /// @returns Whether it is.
  bool consider(const Eigen::VectorXd& q, double share = 1.0);

  const Result& incumbent() const { return incumbent_; }
  /// Where the incumbent leads.
  const Eigen::VectorXd& aim() const { return aim_; }
  /// Whether a candidate was taken.
  bool took() const { return took_; }
  /// Whether it leads to where the goals are met.
  bool meets_goals() const { return worth_.reached; }
  /// Whether there is nothing left to be done.
  bool done() const { return incumbent_.success && worth_.reached && worth_.pull == 0.0; }
  /// Whether it is clear of everything.
  bool clear() const { return room_.least() >= -model_.options.clearance_tolerance; }
  /// Whether some goal stands.
  bool stands() const { return stands_; }
  /// Whether the last candidate was refused because what stands would give way.
  bool gives_way() const { return gives_way_; }
  /// How deep in something the last candidate was, 0 to rounding [m].
  double missed() const { return missed_; }
  /// Where that was judged: where it comes to rest.
  const Eigen::VectorXd& tried() const { return rest_; }
  /// By how much what it leads to falls short of the goals, as the search weighs them.
  double shortfall() const { return worth_.shortfall; }
  int late_evaluations() const {
    return incumbent_.late_evaluations + candidate_.late_evaluations + probe_.late_evaluations;
  }

 private:
  /// Room before contact, by kind; negative in it [m]. And how far what stands is off, negative.
  struct Room {
    double obstacles, self, balance, stance;
    double least() const { return std::min({obstacles, self, balance}); }
  };
  /// Of a verdict, the configuration that it is of included.
  Room room(const Result& verdict);
  /// Of goals that stand, with the robot somewhere.
  double stance_at(const Eigen::VectorXd& q);
  /// Whether anything is deeper than standing still, and than contact, or what stands farther off.
  bool is_deeper(const Room& room, double stance);
  /// What a configuration is worth, whatever it touches.
  struct Worth {
    double shortfall, pull;  ///< of the goals, which come first, and of the posture
    bool reached;            ///< the goals, in their tolerances
  };
  Worth worth_at(const Eigen::VectorXd& q);
  /// Whether that is better than what the incumbent is worth, by more the farther it is.
  bool is_better(const Worth& worth, const Eigen::VectorXd& q) const;
  /// How far it is to a configuration, of how far each joint may go, the most of all joints.
  double share_of_box(const Eigen::VectorXd& q) const;
  /// Whether nothing gets deeper on a way, of which a length is known [m] and of both ends the
  /// room, as far as these say.
  bool is_clear_by_ends(double length, const Room& one, const Room& other) const;
  /// Or between two shares of it, with looks at what is between; at(share) is a configuration on
  /// it.
  template <class At>
  bool is_clear_between(const At& at, double way, double first, double last, const Room& one,
                        const Room& other);
  /// The same of the way to where a step ends, next_, and of that from there to rest, rest_.
  bool is_clear_to_end(const Room& end);
  bool is_clear_to_rest(const Room& end, const Room& rest);
  /// A bound on how far any part of a hull gets on the way from where the step begins [m], soon
  /// known, and a tighter one.
  double way_to(const Eigen::VectorXd& q);
  double tight_way_to(const Eigen::VectorXd& q);
  /// The displacement bounds of all that is moved, between where the step begins and a
  /// configuration.
  const Eigen::VectorXd& levers_to(const Eigen::VectorXd& q);
  void judge(const Eigen::VectorXd& q, Result& result);

  Workspace& workspace_;
  const Model& model_;
  const StepRequest* step_ = nullptr;
  Rollout at_start_;               ///< where the step begins,
  CollisionState hulls_at_start_;  ///< ... if that was asked for
  bool is_placed_ = false;
  std::vector<GoalTerm> asked_;
  Room held_{}, room_{};         ///< of standing still, of where the incumbent comes to rest
  Room floor_{};                 ///< what no candidate may be below
  double stance_between_ = 0.0;  ///< the same of stance on the way
  Worth worth_{};                ///< of what the incumbent leads to
  bool took_ = false, gives_way_ = false;
  bool stands_ = false;  ///< some goal
  double finest_, missed_ = 0.0;
  Result incumbent_, candidate_, probe_;
  Eigen::VectorXd aim_, trial_, next_, rest_, at_, way_, displacement_bounds_, all_bounds_;
};

}  // namespace pdoik::detail
