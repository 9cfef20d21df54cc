#include "paths/path_smoothing.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace pdoik::detail {
namespace {

constexpr int kSteps = 20;
constexpr double kEnough = 1e-3;    ///< relative gain below which it ends
constexpr double kLongest = 0.3;    ///< step of a joint [rad] or [m]
constexpr double kShortest = 1e-3;  ///< motion from which on its length counts, not its square
constexpr double kRank = 1e-6;
constexpr double kProbe = 1e-3;  ///< for slopes of what places cost [rad] or [m]

/// Directions that leave the goals met at a point, (n, r): none of joints at their bounds.
Eigen::MatrixXd free_directions(PathStepper& stepper, const PathPoint& point) {
  Workspace& workspace = stepper.workspace();
  LeastSquaresProblem& least_squares = workspace.least_squares;
  const Eigen::Index n = point.q.size();
  workspace.problem.set_goals(stepper.goals().at(point.at));
  least_squares.evaluate_goals(point.q);
  std::vector<LeastSquaresProblem::Column> columns(static_cast<std::size_t>(n));
  std::vector<Eigen::Index> held;
  const Eigen::VectorXd &lower = stepper.lower(), &upper = stepper.upper();
  for (Eigen::Index i = 0; i < n; ++i) {
    if (point.q[i] <= lower[i] || point.q[i] >= upper[i]) held.push_back(i);
  }
  const auto goals = static_cast<Eigen::Index>(workspace.problem.goals.size());
  Eigen::MatrixXd rows =
      Eigen::MatrixXd::Zero(6 * goals + static_cast<Eigen::Index>(held.size()), n);
  for (Eigen::Index g = 0; g < goals; ++g) {
    const GoalTerm& goal = workspace.problem.goals[static_cast<std::size_t>(g)];
    least_squares.find_columns(goal, columns);
    for (Eigen::Index i = 0; i < n; ++i) {
      LeastSquaresProblem::Column& column = columns[static_cast<std::size_t>(i)];
      goal.to_error_rates(column.linear, column.angular);
      rows.block<3, 1>(6 * g, i) = to_vector3(column.linear);
      rows.block<3, 1>(6 * g + 3, i) = to_vector3(column.angular);
    }
  }
  for (std::size_t k = 0; k < held.size(); ++k)
    rows(6 * goals + static_cast<Eigen::Index>(k), held[k]) = 1.0;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(rows.transpose());
  qr.setThreshold(kRank);
  const Eigen::MatrixXd Q = qr.householderQ();
  return Q.rightCols(n - qr.rank());
}

/// Minimises the sum of w_k |q_{k+1} + Z_{k+1} z_{k+1} - q_k - Z_k z_k|^2 / 2 and what places cost,
/// to first order, by elimination from one end to the other.
class Chain {
 public:
  void begin(std::size_t count) {
    diagonal_.resize(count);
    upper_.resize(count);
    right_.resize(count);
  }
  void set(std::size_t k, Eigen::Index free) {
    diagonal_[k] = 1e-9 * Eigen::MatrixXd::Identity(free, free);
    right_[k] = Eigen::VectorXd::Zero(free);
  }
  void join(std::size_t k, double w, const Eigen::VectorXd& way, const Eigen::MatrixXd& Z,
            const Eigen::MatrixXd& next_Z) {
    diagonal_[k] += w * Eigen::MatrixXd::Identity(Z.cols(), Z.cols());
    diagonal_[k + 1] += w * Eigen::MatrixXd::Identity(next_Z.cols(), next_Z.cols());
    upper_[k] = -w * (Z.transpose() * next_Z);
    right_[k] += w * (Z.transpose() * way);
    right_[k + 1] -= w * (next_Z.transpose() * way);
  }
  void pull(std::size_t k, const Eigen::VectorXd& slope) { right_[k] -= slope; }
  std::vector<Eigen::VectorXd>& solve() {
    const std::size_t count = right_.size();
    for (std::size_t k = 0; k + 1 < count; ++k) {
      if (right_[k].size() == 0 || right_[k + 1].size() == 0) continue;
      const Eigen::MatrixXd factor = upper_[k].transpose() * diagonal_[k].partialPivLu().inverse();
      diagonal_[k + 1] -= factor * upper_[k];
      right_[k + 1] -= factor * right_[k];
    }
    for (std::size_t k = count; k-- > 0;) {
      if (right_[k].size() == 0) continue;
      if (k + 1 < count && right_[k + 1].size() > 0) right_[k] -= upper_[k] * right_[k + 1];
      right_[k] = diagonal_[k].partialPivLu().solve(right_[k]).eval();
    }
    return right_;
  }

 private:
  std::vector<Eigen::MatrixXd> diagonal_, upper_;
  std::vector<Eigen::VectorXd> right_;
};

/// How what a place costs changes along directions.
Eigen::VectorXd slope_of(PathStepper& stepper, const PathCost& cost, const PathPoint& point,
                         const Eigen::MatrixXd& Z) {
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(Z.cols());
  for (Eigen::Index i = 0; i < Z.cols(); ++i) {
    double ends[2];
    for (int side = 0; side < 2; ++side) {
      PathPoint probe = point;
      probe.q += (side == 0 ? -kProbe : kProbe) * Z.col(i);
      probe.room = stepper.sweep().room_at(stepper.goals().at(point.at), probe.q);
      ends[side] = cost.of_place(stepper, probe);
    }
    slope[i] = (ends[1] - ends[0]) / (2.0 * kProbe);
  }
  return slope;
}

}  // namespace

bool smooth(PathStepper& stepper, const PathCost& cost, std::vector<PathPoint>& route, Kept kept) {
  stepper.workspace().watch(stepper.deadline());
  const std::size_t count = route.size();
  std::vector<double> ways(count, 0.0);
  for (std::size_t k = 1; k < count; ++k)
    ways[k] = stepper.goals().way(static_cast<int>(route[k - 1].at), static_cast<int>(route[k].at));
  double least = cost.of_all(stepper, route);
  const double before = least;
  std::vector<Eigen::MatrixXd> Z(count);
  Chain chain;
  for (int step = 0; step < kSteps && !stepper.deadline().passed(); ++step) {
    chain.begin(count);
    bool is_free = false;
    for (std::size_t k = 0; k < count; ++k) {
      const bool stays = (k == 0 && kept.first) || (k + 1 == count && kept.last);
      Z[k] = stays ? Eigen::MatrixXd(route[k].q.size(), 0) : free_directions(stepper, route[k]);
      is_free = is_free || Z[k].cols() > 0;
      chain.set(k, Z[k].cols());
      if (cost.minds_places() && Z[k].cols() > 0)
        chain.pull(k, ways[k] * slope_of(stepper, cost, route[k], Z[k]));
    }
    if (!is_free) break;
    for (std::size_t k = 0; k + 1 < count; ++k) {
      const Eigen::VectorXd way = route[k + 1].q - route[k].q;
      const double w = cost.of_motion(route[k].q, route[k + 1].q) /
                       std::max(way.squaredNorm(), kShortest * kShortest);
      chain.join(k, w, way, Z[k], Z[k + 1]);
    }
    const std::vector<Eigen::VectorXd>& z = chain.solve();
    bool better = false;
    for (double share = 1.0; share > 0.2 && !better; share *= 0.5) {
      std::vector<PathPoint> tried = route;
      for (std::size_t k = 0; k < count; ++k) {
        if (Z[k].cols() == 0) continue;
        Eigen::VectorXd d = share * (Z[k] * z[k]);
        const double most = d.cwiseAbs().maxCoeff();
        if (most < 1e-6) continue;
        if (most > kLongest) d *= kLongest / most;
        PathPoint point;
        const Eigen::VectorXd aim = route[k].q + d;
        if (stepper.bring(route[k].at, aim, most, point)) tried[k] = std::move(point);
      }
      const double cost_now = cost.of_all(stepper, tried);
      if (!(cost_now < least)) continue;
      better = cost_now < (1.0 - kEnough) * least;
      least = cost_now;
      route = std::move(tried);
      if (!better) break;
    }
    if (!better) break;
  }
  return least < before;
}

}  // namespace pdoik::detail
