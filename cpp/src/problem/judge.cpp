#include "problem/judge.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/goal_of.hpp"

namespace pdoik::detail {
namespace {

/// By how much each component is beyond its slack.
Eigen::Vector3d beyond(const Eigen::Vector3d& error, const Eigen::Vector3d& slack) {
  return (error.cwiseAbs() - slack).cwiseMax(0.0);
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The angle of a rotation, or where there is slack the length of what its vector has beyond it.
double pose_rotation_error(const Eigen::Matrix3d& R, const Eigen::Vector3d& slack) {
  const Eigen::Vector3d twice_sine(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  if (slack.isZero(0.0)) return std::atan2(twice_sine.norm(), R.trace() - 1.0);
  const Eigen::AngleAxisd turn(R);
  return beyond(turn.angle() * turn.axis(), slack).norm();
}

/// Farther than this from the base rounding blurs distances to more than any tolerance [m].
constexpr double kFarthest = 1e9;

/// Whether all bodies are where something can be said of them: a joint that slides without limits,
/// or angles that overflow, may put one too far or nowhere.
bool are_somewhere(const std::vector<Eigen::Isometry3d>& T_base_body) {
  return std::all_of(T_base_body.begin(), T_base_body.end(), [](const Eigen::Isometry3d& T) {
    return T.matrix().allFinite() && T.translation().cwiseAbs().maxCoeff() <= kFarthest;
  });
}

}  // namespace

class Judge::Verdict {
 public:
  Verdict(Result& result, double rotation_weight)
      : result_(result), rotation_weight_(rotation_weight) {
    worst_length_ = result.worst.violation;  // of limits, which come first
    result.success = result.holds = result.worst.violation <= 0.0;
  }

  /// @param violation  Beyond its tolerance [m] or [rad]; radians of a tip weigh as in the search.
  /// @param counts  Whether `holds` looks at it.
  void add(WorstConstraint::Kind kind, double violation, int index, int obstacle = -1,
           bool counts = true) {
    result_.success = result_.success && violation <= 0.0;
    result_.holds = result_.holds && (violation <= 0.0 || !counts);
    const double length =
        kind == WorstConstraint::Kind::Rotation ? rotation_weight_ * violation : violation;
    if (length <= worst_length_) return;
    result_.worst = {kind, index, obstacle, violation};
    worst_length_ = length;
  }

 private:
  Result& result_;
  double rotation_weight_, worst_length_;
};

Judge::Judge(const Robot& robot, const Options& options, const HullModel& hulls,
             const HullModel& whole)
    : robot_(robot),
      options_(options),
      hulls_(hulls),
      whole_(whole),
      T_base_body_(robot.bodies().size()),
      collision_(hulls, hulls.moving),
      fixed_hulls_(hulls, hulls.fixed),
      capsules_(robot, hulls, hulls.moving, options.clearance),
      balance_(robot, options.balance) {
  for (CollisionState* state : {&collision_, &fixed_hulls_})
    state->reserve(static_cast<int>(CollisionState::kChunk), CollisionState::kChunk);
  if (options.keeps_off_itself(robot)) by_pairs_.self.emplace(robot, whole, options.self_clearance);
}

void Judge::judge_goal(const Goal& goal, Verdict& verdict, Result& result) const {
  const auto T_base_tip = [&](int tip) -> Eigen::Isometry3d {
    const int link = robot_.tips()[static_cast<std::size_t>(tip)];
    return T_base_body_[static_cast<std::size_t>(robot_.body_of_link(link))] *
           robot_.T_body_link(link);
  };
  Eigen::Isometry3d T = T_base_tip(goal.tip);
  if (!goal.T_tip_tool.matrix().isIdentity(0.0)) T = T * goal.T_tip_tool;
  const Eigen::Isometry3d target =
      goal.relative_to < 0 ? goal.T_base_tip : T_base_tip(goal.relative_to) * goal.T_base_tip;
  const Eigen::Vector3d off = T.translation() - target.translation();
  if (goal.type != GoalType::LookAt) {
    const double position_error =
        goal.position_slack.isZero(0.0)
            ? off.norm()
            : beyond(target.linear().transpose() * off, goal.position_slack).norm();
    result.position_error = std::max(result.position_error, position_error);
    verdict.add(WorstConstraint::Kind::Position,
                position_error - position_tolerance(goal, options_), goal.tip);
  }
  if (goal.type == GoalType::Position) return;
  const Eigen::Vector3d axis = goal.axis.normalized();
  const double rotation_error =
      goal.type == GoalType::Pose
          ? pose_rotation_error(target.linear().transpose() * T.linear(), goal.rotation_slack)
          : std::max(0.0, angle_between(T.linear() * axis, goal.type == GoalType::LookAt
                                                               ? Eigen::Vector3d(-off)
                                                               : target.linear() * axis) -
                              goal.rotation_slack.maxCoeff());
  result.rotation_error = std::max(result.rotation_error, rotation_error);
  verdict.add(WorstConstraint::Kind::Rotation, rotation_error - rotation_tolerance(goal, options_),
              goal.tip, -1, goal.priority != Priority::Position);
}

void Judge::judge_limits(const Eigen::VectorXd& q, Result& result) const {
  WorstConstraint& worst = result.worst;
  worst = {WorstConstraint::Kind::Limit, -1, -1, -std::numeric_limits<double>::infinity()};
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double violation = std::max(robot_.lower()[i] - q[i], q[i] - robot_.upper()[i]);
    if (violation > worst.violation) {
      worst.index = static_cast<int>(i);
      worst.violation = violation;
    }
  }
  result.limit_violation = std::max(0.0, worst.violation);
}

void Judge::judge_balance(Verdict& verdict, Result& result) {
  if (!balance_.wanted()) return;
  balance_.place([&](int body) { return to_frame(T_base_body_[static_cast<std::size_t>(body)]); });
  result.center_of_mass = to_vector3(balance_.com());
  result.balance_violation = 0.0;
  balance_.for_each([](int) { return std::numeric_limits<double>::infinity(); },
                    [&](const Balance::Term& term) {
                      // A centre of mass that overflowed is nowhere.
                      const double c =
                          std::isnan(term.c) ? std::numeric_limits<double>::infinity() : term.c;
                      result.balance_violation = std::max(result.balance_violation, c);
                      verdict.add(WorstConstraint::Kind::Balance, c - options_.clearance_tolerance,
                                  std::min(term.slot, Balance::kBox));
                    });
}

void Judge::judge_points(const Scene& scene, const Pairs& pairs, double look, Asked& asked,
                         Verdict* verdict, Least& least) {
  const ObstacleView points = scene.obstacles(pairs);
  if (points->count() == 0) return;
  const double wanted = options_.clearance;  // which radii include
  const bool is_known = asked.fixed_stamp == scene.points_stamp() &&
                        (asked.fixed.source >= 0 || look - wanted <= asked.fixed_look);
  if (!is_known) {
    asked.fixed_look = look - wanted;
    asked.fixed = least_clearance(fixed_hulls_, points, {asked.fixed_look, -1, -1});
    asked.fixed_stamp = scene.points_stamp();
  }
  const Clearance known =
      asked.fixed.distance < look - wanted ? asked.fixed : Clearance{look - wanted, -1, -1};
  const Clearance found = least_clearance(collision_, points, known);
  least.obstacles = found.distance + wanted;
  if (found.source < 0 || verdict == nullptr) return;  // nothing is within `look`
  verdict->add(WorstConstraint::Kind::Clearance, -found.distance - options_.clearance_tolerance,
               found.source, found.obstacle);
}

void Judge::judge_shapes(const Pairs& pairs, double look, Verdict* verdict, Least& least) {
  if (pairs.shapes.count() == 0) return;
  capsules_.place(collision_.positions(), collision_.frames());
  ShapeClearance found = pairs.fixed_to_shapes;
  const double than = std::min(look, found.distance);
  const ShapeClearance moving = least_clearance(capsules_, pairs.shapes, than);
  if (moving.shape >= 0 || look < found.distance) found = moving;
  least.obstacles = std::min(least.obstacles, found.distance);
  if (found.shape < 0 || verdict == nullptr) return;
  verdict->add(WorstConstraint::Kind::Shape,
               options_.clearance - found.distance - options_.clearance_tolerance, found.source,
               found.shape);
}

void Judge::attach(const Scene& scene) {
  const auto attach = [&](Asked& asked, const Attachments& attached) {
    asked.attachments.reset();
    if (attached.count() > 0) asked.attachments.emplace(robot_, hulls_, options_, attached);
  };
  attach(by_pairs_, scene.pairs().attachments);
  if (scene.has_own_clearances()) attach(plain_, scene.plain_pairs().attachments);
}

void Judge::keep_off_itself(const Scene& scene) {
  if (!options_.keeps_off_itself(robot_)) return;
  const double wanted = options_.self_clearance;
  const PairMargins &margins = scene.pairs().margins, &plain = scene.plain_pairs().margins;
  by_pairs_.self.emplace(robot_, whole_, wanted, margins);
  plain_.self.reset();
  if (!margins.are_alike_of_links(plain)) plain_.self.emplace(robot_, whole_, wanted, plain);
}

void Judge::judge_attached(const Scene& scene, const Pairs& pairs, double look, Asked& asked,
                           Verdict* verdict, Least& least) {
  if (!asked.attachments) return;
  AttachmentClearance& attached = *asked.attachments;
  const auto frame_of = [&](int body) {
    return to_frame(T_base_body_[static_cast<std::size_t>(body)]);
  };
  attached.place(frame_of, collision_.positions(), collision_.frames());
  const auto note = [&](const std::optional<AttachmentNear>& near, double& to, double wanted) {
    if (!near) return;
    to = near->distance + wanted;  // only what is nearer was asked for
    if (verdict == nullptr) return;
    verdict->add(near->kind, -near->distance - options_.clearance_tolerance, near->attached,
                 near->other);
  };
  const auto within = [&](double to, double wanted) { return std::min(look, to) - wanted; };
  const double wanted = options_.clearance, off_itself = options_.self_clearance;
  const ObstacleView points = scene.obstacles(pairs);
  for (int k = 0; k < attached.count(); ++k) {
    note(attached.nearest_point(k, points, within(least.obstacles, wanted)), least.obstacles,
         wanted);
    note(attached.nearest_shape(k, pairs.shapes, within(least.obstacles, wanted)), least.obstacles,
         wanted);
    for (int hull = 0; hull < attached.hulls(); ++hull)
      note(attached.nearest_of_hull(k, hull, within(least.self, off_itself)), least.self,
           off_itself);
    for (int other = 0; other < k; ++other)
      note(attached.nearest_of_attached(k, other, within(least.self, off_itself)), least.self,
           off_itself);
  }
}

void Judge::judge_hulls(Asked& asked, Verdict* verdict, Least& least) {
  if (!asked.self) return;
  asked.self->place(collision_.positions(), collision_.frames());
  const SelfCollision::Least found = asked.self->least();
  least.self = found.distance;
  if (found.pair < 0) return;
  const auto& [one, other] = found.source;
  if (one < 0 || verdict == nullptr) return;  // none is anywhere near
  verdict->add(WorstConstraint::Kind::SelfCollision,
               options_.self_clearance - found.distance - options_.clearance_tolerance, one, other);
}

void Judge::operator()(std::span<const Goal> goals, const Eigen::VectorXd& q, const Scene& scene,
                       Result& result, double look) {
  look = std::max(look, options_.clearance);
  result.q = q;
  robot_.body_poses(q, T_base_body_);
  collision_.place(T_base_body_);
  judge_limits(q, result);
  Verdict verdict(result, options_.rotation_weight);
  const bool somewhere = are_somewhere(T_base_body_);
  result.success = result.success && somewhere;
  result.holds = result.holds && somewhere;
  Least least;
  judge_points(scene, scene.pairs(), look, by_pairs_, &verdict, least);
  judge_shapes(scene.pairs(), look, &verdict, least);
  result.position_error = result.rotation_error = 0.0;
  for (const Goal& goal : goals) {
    if (!goal.soft && goal.type != GoalType::CenterOfMass) judge_goal(goal, verdict, result);
  }
  balance_.ask(goals);
  judge_balance(verdict, result);
  judge_hulls(by_pairs_, &verdict, least);
  judge_attached(scene, scene.pairs(), look, by_pairs_, &verdict, least);
  result.room = least.obstacles - options_.clearance;
  result.self_room = least.self - options_.self_clearance;
  if (scene.has_own_clearances()) {
    const Pairs& pairs = scene.plain_pairs();
    least = {};
    judge_points(scene, pairs, look, plain_, nullptr, least);
    judge_shapes(pairs, look, nullptr, least);
    judge_hulls(plain_.self ? plain_ : by_pairs_, nullptr, least);
    judge_attached(scene, pairs, look, plain_, nullptr, least);
  }
  result.clearance = least.obstacles;
  result.self_distance = least.self;
}

}  // namespace pdoik::detail
