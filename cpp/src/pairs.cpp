#include "detail/pairs.hpp"

#include <algorithm>

namespace pdoik::detail {
namespace {

std::vector<double> point_margins(const Model& model, const PairMargins& margins) {
  std::vector<double> by_source;
  if (!margins.speak_of_points()) return by_source;
  by_source.assign(model.robot.occupancy().size(), 0.0);
  for (const Hull& hull : model.hulls.all()) {
    const auto [one, other] = seat_of(model.robot, model.hulls, hull);
    by_source[static_cast<std::size_t>(hull.source)] = margins.to_points({one, other});
  }
  return by_source;
}

}  // namespace

Pairs::Pairs(const Model& model, std::shared_ptr<const ShapeSet> set, Held::Solids solids,
             PairMargins margins_in, HullCapsules& fixed)
    : margins(std::move(margins_in)),
      shapes(std::move(set), model.robot, margins),
      held(std::move(solids), model.robot, model.hulls, shapes, margins),
      points(point_margins(model, margins)),
      fixed_to_shapes(least_clearance(fixed, shapes)) {
  for (const double margin : points) most_point_margin = std::max(most_point_margin, margin);
  fixed_to_shapes.capsule = nullptr;  // which is another's
}

}  // namespace pdoik::detail
