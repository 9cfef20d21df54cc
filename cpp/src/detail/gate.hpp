#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

#include "detail/workspace.hpp"

namespace pdoik::detail {

/// What a step of a control loop is asked.
struct StepRequest {
  std::span<const Goal> goals;
  const Eigen::VectorXd *from, *lower, *upper;  ///< the last answer, and bounds about it
  const Eigen::VectorXd *pull_to, *pull;        ///< see PosturePull: what the search is pulled to
  const Eigen::VectorXd *posture, *weights;     ///< what is better beside the goals; may be null
  double max_time;                              ///< [s]
  /// Obstacles farther than this from the hulls cannot be met within a step; may be infinite [m].
  double margin;
  double advance, turn;  ///< how far a tip may be asked to go in one step [m], [rad]
  double look;           ///< clearance beyond this is told as this [m]
};

/// Guards what goes to the motors: the incumbent, which is to stand still at first. A candidate
/// takes its place only if it is no deeper in anything than standing still, nor than contact, all
/// along the straight way there, and better. Whenever the clock strikes, the incumbent goes out.
class Gate {
 public:
  /// The workspace outlives it.
  explicit Gate(Workspace& workspace);

  /// Begin a step: judge standing still.
  void open(const StepRequest& step);
  /// How much of the way to a configuration there is time to look at, 1 for all of it.
  double share_in_time(const Eigen::VectorXd& q);
  /// Take what is a share of the way to a configuration as the incumbent. @returns Whether it is.
  bool consider(const Eigen::VectorXd& q, double share = 1.0);

  const Result& incumbent() const { return incumbent_; }
  /// Whether it is clear of everything.
  bool clear() const { return room_.least() >= -model_.options.clearance_tolerance; }
  /// How deep in something the last candidate was, 0 to rounding [m].
  double missed() const { return missed_; }
  /// By how much it falls short of the goals, as the search weighs them.
  double shortfall() const { return worth_.shortfall; }
  /// What pulls at it beside the goals.
  double pull() const { return worth_.pull; }
  int late_evaluations() const {
    return incumbent_.late_evaluations + candidate_.late_evaluations + probe_.late_evaluations;
  }

 private:
  /// Room before contact, by kind; negative in it [m].
  struct Room {
    double obstacles, self, balance;
    double least() const { return std::min({obstacles, self, balance}); }
  };
  Room room(const Result& verdict) const;
  /// Whether anything is deeper than standing still, and than contact.
  bool is_deeper(const Room& room) const;
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
  /// Whether nothing gets deeper between two shares of the straight way to a configuration, which
  /// is so long [m].
  bool is_clear_between(const Eigen::VectorXd& to, double way, double first, double last,
                        const Room& one, const Room& other);
  /// A bound on how far any part of a hull gets on the way from where the step begins [m].
  double way_to(const Eigen::VectorXd& q);
  void judge(const Eigen::VectorXd& q, Result& result);

  Workspace& workspace_;
  const Model& model_;
  const StepRequest* step_ = nullptr;
  std::vector<GoalTerm> asked_;
  Room held_{}, room_{};  ///< of standing still, of the incumbent
  Room floor_{};          ///< what no candidate may be below
  Worth worth_{};         ///< of the incumbent
  double finest_, missed_ = 0.0;
  Result incumbent_, candidate_, probe_;
  Eigen::VectorXd trial_, at_, levers_, held_levers_;
};

}  // namespace pdoik::detail
