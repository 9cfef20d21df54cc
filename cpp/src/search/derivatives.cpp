#include "search/derivatives.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

namespace pdoik::detail {
namespace {

/// What is no farther from contact than this is kept as far [m].
constexpr double kContact = 1e-6;
/// What is no farther from a limit than this stays there [rad] or [m].
constexpr double kAtLimit = 1e-9;

/// A determinant of lengths that is none [m^6].
constexpr double kSingular = 1e-12;

using Column = LeastSquaresProblem::Column;

/// Rows of one goal: its Jacobian, and how the same errors change with the target. The directions
/// that slack leaves free have none.
class GoalRows {
 public:
  GoalRows(const GoalTerm& goal, std::vector<Column> columns)
      : goal_(goal), columns_(std::move(columns)) {
    const Frame& target = goal.target();
    for (Column& column : columns_) goal.to_error_rates(column.linear, column.angular);
    const bool looks = goal.type() == GoalType::LookAt;
    const Vec4 arm = looks ? Vec4{} : goal.tip().p - target.p;
    for (int k = 0; k < 6; ++k) {
      const Vec4 unit = to_vec4(Eigen::Vector3d::Unit(k % 3));
      Column& moves = targets_[k];
      moves.linear = k < 3 ? unit : cross3(unit, arm);
      moves.angular = k < 3 || looks || !goal.turns() ? Vec4{} : unit;
      goal.to_error_rates(moves.linear, moves.angular);
    }
    for (const Vec4& axis : {target.x, target.y, target.z}) add(axis, &Column::linear, 1.0);
    if (goal.by_axis()) {
      const Eigen::Vector3d wanted = to_vector3(goal.wanted_axis()),
                            aside = wanted.unitOrthogonal();
      add(to_vec4(aside), &Column::angular, 0.0);
      add(to_vec4(wanted.cross(aside)), &Column::angular, 0.0);
    } else if (goal.turns()) {
      for (const Vec4& axis : {target.x, target.y, target.z}) add(axis, &Column::angular, 0.0);
    }
  }

  struct Row {
    Eigen::VectorXd by_joints;
    Eigen::Matrix<double, 1, 6> by_target;
    bool is_length;
  };
  std::vector<Row> rows;

 private:
  void add(const Vec4& axis, Vec4 Column::* part, double is_length) {
    Row row{Eigen::VectorXd(static_cast<Eigen::Index>(columns_.size())), {}, is_length > 0.0};
    for (std::size_t i = 0; i < columns_.size(); ++i)
      row.by_joints[static_cast<Eigen::Index>(i)] = dot3(axis, columns_[i].*part);
    for (int k = 0; k < 6; ++k) row.by_target[k] = dot3(axis, targets_[k].*part);
    if (!row.by_target.isZero(0.0)) rows.push_back(std::move(row));
  }

  const GoalTerm& goal_;
  std::vector<Column> columns_;
  Column targets_[6];
};

}  // namespace

bool is_singular(Workspace& workspace, std::span<const Goal> goals, const Eigen::VectorXd& q) {
  const Model& model = workspace.model();
  LeastSquaresProblem& least_squares = workspace.least_squares;
  workspace.problem.set_goals(goals);
  least_squares.evaluate_goals(q);
  std::vector<Column> columns(static_cast<std::size_t>(q.size()));
  Eigen::Matrix<double, 6, 6> J;
  for (const GoalTerm& goal : workspace.problem.goals) {
    least_squares.find_columns(goal, columns);
    Eigen::Index count = 0;
    for (const Column& column : columns) {
      const Eigen::Vector3d linear = to_vector3(column.linear), turn = to_vector3(column.angular);
      if (linear.isZero(0.0) && turn.isZero(0.0)) continue;  // of a joint that moves no tip
      if (count == 6) return false;
      J.col(count++) << linear, model.options.rotation_weight * turn;
    }
    if (count < 6 || std::abs(J.determinant()) < kSingular) return true;
  }
  return false;
}

Derivatives derivatives(Workspace& workspace, std::span<const Goal> goals,
                        const Eigen::VectorXd& q) {
  const Model& model = workspace.model();
  const Eigen::Index n = model.robot.dof();
  Problem& problem = workspace.problem;
  LeastSquaresProblem& least_squares = workspace.least_squares;
  static const Deadline never;
  workspace.watch(never);
  problem.set_goals(goals);
  least_squares.count_all_obstacles();
  least_squares.evaluate(q);

  std::vector<GoalRows::Row> rows;
  std::vector<Eigen::Index> goal_of_row;
  for (const GoalTerm& goal : problem.goals) {
    std::vector<Column> columns(static_cast<std::size_t>(n));
    least_squares.find_columns(goal, columns);
    for (GoalRows::Row& row : GoalRows(goal, std::move(columns)).rows) {
      rows.push_back(std::move(row));
      goal_of_row.push_back(&goal - problem.goals.data());
    }
  }
  const auto count = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd J(count, n), in_metres(count, n);
  Eigen::MatrixXd by_targets =
      Eigen::MatrixXd::Zero(count, 6 * static_cast<Eigen::Index>(problem.goals.size()));
  for (Eigen::Index r = 0; r < count; ++r) {
    const GoalRows::Row& row = rows[static_cast<std::size_t>(r)];
    J.row(r) = row.by_joints;
    in_metres.row(r) = (row.is_length ? 1.0 : model.options.rotation_weight) * row.by_joints;
    by_targets.block<1, 6>(r, 6 * goal_of_row[static_cast<std::size_t>(r)]) = row.by_target;
  }

  std::vector<Eigen::VectorXd> contacts;
  problem.constraints.find(problem.rollout, [](std::size_t, int) { return kContact; });
  problem.constraints.for_each([&](auto& family, std::size_t) {
    for (int k = 0; k < family.count(); ++k) {
      contacts.emplace_back(Eigen::VectorXd::Zero(n));
      family.add_row(family.at(k), problem.rollout, contacts.back().data());
    }
  });
  const Eigen::Index kept = static_cast<Eigen::Index>(contacts.size());
  Eigen::MatrixXd A(count + kept, n);
  A.topRows(count) = J;
  for (Eigen::Index k = 0; k < kept; ++k) A.row(count + k) = contacts[static_cast<std::size_t>(k)];
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(count + kept, by_targets.cols());
  b.topRows(count) = by_targets;

  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (q[i] > model.robot.lower()[i] + kAtLimit && q[i] < model.robot.upper()[i] - kAtLimit)
      free.push_back(i);
  }
  Derivatives result;
  result.dq_dT = Eigen::MatrixXd::Zero(n, by_targets.cols());
  if (count == 0) return result;
  if (!free.empty()) {
    Eigen::MatrixXd moved(A.rows(), static_cast<Eigen::Index>(free.size()));
    for (std::size_t k = 0; k < free.size(); ++k)
      moved.col(static_cast<Eigen::Index>(k)) = A.col(free[k]);
    const Eigen::MatrixXd least =
        Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(moved).pseudoInverse() * b;
    for (std::size_t k = 0; k < free.size(); ++k)
      result.dq_dT.row(free[k]) = least.row(static_cast<Eigen::Index>(k));
  }
  const auto singular_values = [](const Eigen::MatrixXd& of) -> Eigen::VectorXd {
    return Eigen::JacobiSVD<Eigen::MatrixXd>(of).singularValues();
  };
  // Of more rows than joints some are lost wherever it is.
  const bool has_enough = n >= count;
  result.manipulability = has_enough ? singular_values(J).prod() : 0.0;
  result.singular_distance = has_enough ? singular_values(in_metres).minCoeff() : 0.0;
  return result;
}

}  // namespace pdoik::detail
