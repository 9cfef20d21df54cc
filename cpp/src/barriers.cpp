#include "detail/barriers.hpp"

#include <algorithm>
#include <limits>

namespace pdoik::detail {
namespace {

constexpr int kMost = 256;           ///< constraints of a step
constexpr std::size_t kSeen = 4096;  ///< depths that are kept to find the worst
constexpr double kApproach = 0.5;    ///< share of a distance that a step may take
constexpr double kRegular = 1e-8;    ///< of the rows' squares, so that the way out is the shortest
constexpr double kNearly = 0.99;     ///< share of a way out that is one
constexpr double kNoWorse = 1e-11;   ///< by which the way out may be missed [m]

}  // namespace

Barriers::Barriers(const Model& model) : program_(model.robot.dof()) {
  const Eigen::Index n = model.robot.dof();
  rows_.setZero(n, kMost);
  hessian_.setZero(n, n);
  for (Eigen::VectorXd* v : {&gradient_, &out_}) v->setZero(n);
  for (Eigen::VectorXd* v : {&most_, &soft_}) v->setZero(kMost);
  found_.reserve(kSeen);
}

bool Barriers::find(Problem& problem, double reach, double stand_off) {
  Constraints& all = problem.constraints;
  all.obstacles.use(problem.scene->obstacles(), ObstacleConstraints::Form::Distance);
  all.shapes.use(problem.scene->shapes(), problem.model.options.clearance);
  all.held.use(true);
  all.find(problem.rollout, [&](std::size_t, int) { return reach; });
  double least = -reach;
  found_.clear();
  bool late = false;
  all.for_each([&](const auto& family, std::size_t number) {
    for (int k = 0; k < family.count() && !late; ++k) {
      late = problem.is_late(k);
      const double c = family.at(k).c;
      if (c <= least) continue;
      if (found_.size() == kSeen) {
        keep_worst();
        least = found_.back().c;
      }
      found_.push_back({c, static_cast<int>(number), k});
    }
  });
  if (late || problem.deadline->struck()) return false;
  keep_worst();
  count_ = violated_ = 0;
  all.for_each([&](auto& family, std::size_t number) {
    for (const Found& each : found_) {
      if (each.family != static_cast<int>(number)) continue;
      rows_.col(count_).setZero();
      family.add_row(family.at(each.k), problem.rollout, rows_.col(count_).data());
      const double c = each.c + stand_off;
      if (c > 0.0) ++violated_;
      most_[count_++] = c > 0.0 ? -c : -kApproach * c;
    }
  });
  return !problem.deadline->passed();
}

void Barriers::keep_worst() {
  if (found_.size() <= kMost) return;
  std::nth_element(found_.begin(), found_.begin() + (kMost - 1), found_.end(),
                   [](const Found& one, const Found& other) { return one.c > other.c; });
  found_.resize(kMost);
}

void Barriers::come_to_terms(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  out_.setZero();
  met_ = true;
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
    const double had = rows_.col(i).dot(out_) + kNoWorse;
    met_ = met_ && had < kNearly * most_[i];
    most_[i] = std::max(most_[i], had);
  }
}

}  // namespace pdoik::detail
