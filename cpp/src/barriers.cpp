#include "detail/barriers.hpp"

#include <algorithm>
#include <limits>

namespace pdoik::detail {
namespace {

constexpr int kMost = 256;           ///< constraints of a step where it begins
constexpr int kCuts = 64;            ///< and where it was found to be in something
constexpr double kAbout = 1e-3;      ///< what is so near there is cut off as well [m]
constexpr double kBeyond = 0.5;      ///< share of a depth by which it is held off
constexpr std::size_t kSeen = 4096;  ///< depths that are kept to find the worst
constexpr int kDense = 4;            ///< times as many points as are kept, from which few are near
constexpr double kNearFirst = 1.0 / 16.0;  ///< share of the reach that is then looked at first
constexpr double kApproach = 0.5;    ///< share of a distance that a step may take
constexpr double kRegular = 1e-8;    ///< of the rows' squares, so that the way out is the shortest
constexpr double kNoWorse = 1e-11;   ///< by which the way out may be missed [m]

}  // namespace

Barriers::Barriers(const Model& model) : program_(model.robot.dof()) {
  const Eigen::Index n = model.robot.dof();
  rows_.setZero(n, kMost + kCuts);
  hessian_.setZero(n, n);
  for (Eigen::VectorXd* v : {&gradient_, &out_}) v->setZero(n);
  for (Eigen::VectorXd* v : {&most_, &soft_}) v->setZero(kMost + kCuts);
  found_.reserve(kSeen);
}

bool Barriers::gather(Problem& problem, double reach, std::size_t most) {
  Constraints& all = problem.constraints;
  all.obstacles.use(problem.scene->obstacles(), ObstacleConstraints::Form::Distance);
  all.shapes.use(problem.scene->shapes(), problem.model.options.clearance);
  all.held.use(true);
  // Of a dense cloud the worst lie so near that most points within reach need no look.
  const bool dense = problem.scene->within_reach() > kDense * static_cast<int>(most);
  double near = dense ? kNearFirst * reach : reach;
  while (true) {
    all.find(problem.rollout, [&](std::size_t number, int) {
      return number == Constraints::kObstacles ? near : reach;
    });
    if (!look_at_all(problem, reach, most)) return false;
    keep_worst(most);
    if (near >= reach || (found_.size() == most && found_.back().c >= -near)) return true;
    near *= 2.0;
  }
}

bool Barriers::look_at_all(Problem& problem, double reach, std::size_t most) {
  double least = -reach;
  found_.clear();
  bool late = false;
  problem.constraints.for_each([&](const auto& family, std::size_t number) {
    for (int k = 0; k < family.count() && !late; ++k) {
      late = problem.is_late(k);
      const double c = family.at(k).c;
      if (c <= least) continue;
      if (found_.size() == kSeen) {
        keep_worst(most);
        least = found_.back().c;
      }
      found_.push_back({c, static_cast<int>(number), k});
    }
  });
  return !late && !problem.deadline->struck();
}

template <class Most>
void Barriers::add_rows(Problem& problem, Most&& most) {
  problem.constraints.for_each([&](auto& family, std::size_t number) {
    for (const Found& each : found_) {
      if (each.family != static_cast<int>(number)) continue;
      rows_.col(count_).setZero();
      family.add_row(family.at(each.k), problem.rollout, rows_.col(count_).data());
      most_[count_] = most(each.c, rows_.col(count_));
      ++count_;
    }
  });
}

bool Barriers::find(Problem& problem, double reach) {
  if (!gather(problem, reach, kMost)) return false;
  count_ = violated_ = 0;
  add_rows(problem, [&](double c, const auto&) {
    if (c > 0.0) ++violated_;
    return c > 0.0 ? -c : -kApproach * c;
  });
  return !problem.deadline->passed();
}

bool Barriers::cut(Problem& problem, const Eigen::VectorXd& moved) {
  const auto left = static_cast<std::size_t>(rows_.cols() - count_);
  if (left == 0 || !gather(problem, kAbout, std::min<std::size_t>(left, kCuts / 4))) return false;
  add_rows(problem, [&](double c, const auto& row) {
    return std::max(0.0, row.dot(moved) - (c > 0.0 ? (1.0 + kBeyond) * c : c));
  });
  return !problem.deadline->passed();
}

void Barriers::keep_worst(std::size_t most) {
  if (found_.size() < most) return;
  std::nth_element(found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(most) - 1,
                   found_.end(),
                   [](const Found& one, const Found& other) { return one.c > other.c; });
  found_.resize(most);
}

void Barriers::come_to_terms(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  out_.setZero();
  if (violated_ == 0) return;
  hessian_.setZero();
  gradient_.setZero();
  for (int i = 0; i < count_; ++i) {
    soft_[i] = most_[i];
    if (most_[i] >= 0.0) continue;
    hessian_.selfadjointView<Eigen::Upper>().rankUpdate(rows_.col(i));
    gradient_ -= most_[i] * rows_.col(i);
    soft_[i] = std::numeric_limits<double>::infinity();
  }
  hessian_.diagonal().array() += kRegular * std::max(hessian_.diagonal().maxCoeff(), 1e-12);
  const Inequalities hard{rows_, soft_, count_, lower, upper};
  if (!program_.factorise(hessian_) || !program_.solve(gradient_, hard, out_)) out_.setZero();
  for (int i = 0; i < count_; ++i) {
    if (most_[i] >= 0.0) continue;
    most_[i] = std::max(most_[i], rows_.col(i).dot(out_) + kNoWorse);
  }
}

}  // namespace pdoik::detail
