// VAMP's point clouds for the Python of bench/ik/clouds/__main__.py: its headers, our few functions
// about them.
#include <chrono>
#include <cstddef>
#include <vamp/collision/filter.hh>
#include <vamp/planning/validate.hh>
#include <vamp/robots/panda.hh>
#include <vector>

namespace {

using Panda = vamp::robots::Panda;
constexpr std::size_t kRake = vamp::FloatVectorWidth;
using Environment = vamp::collision::Environment<vamp::FloatVector<kRake>>;

constexpr float kReach = 1.19F;  // that VAMP gives Panda, beyond which its filter drops points [m]

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

#pragma GCC visibility push(default)
extern "C" {

/// A CAPT of points (count, 3), for Panda's spheres, in an environment of its own.
/// @param filter  VAMP's filter drops points nearer than this to others, 0 for no filter [m].
/// @param radius  Of a point [m].
/// @param kept  How many points the filter left.
/// @param seconds  What making it took, the filter included.
void* capt_create(const float* points, int count, float filter, float radius, int* kept,
                  double* seconds) {
  std::vector<vamp::collision::Point> rows(static_cast<std::size_t>(count));
  for (auto& row : rows) {
    row = {points[0], points[1], points[2]};
    points += 3;
  }
  auto* environment = new Environment;
  const auto start = std::chrono::steady_clock::now();
  if (filter > 0.0F) {
    rows = vamp::collision::filter_pointcloud(rows, filter, kReach, {0.0F, 0.0F, 0.0F},
                                              {-kReach, -kReach, -kReach}, {kReach, kReach, kReach},
                                              true);
  }
  environment->pointclouds.emplace_back(rows, Panda::min_radius, Panda::max_radius, radius);
  *seconds = seconds_since(start);
  *kept = static_cast<int>(rows.size());
  return environment;
}

void capt_destroy(void* environment) { delete static_cast<Environment*>(environment); }

/// Whether configurations (count, 7) are free of the points and of themselves, one call each, as
/// VAMP's `validate` does, which fills all lanes with one configuration.
void capt_validate(const void* environment, const float* q, int count, unsigned char* free,
                   double* seconds) {
  for (int i = 0; i < count; ++i, q += Panda::dimension) {
    Panda::ConfigurationBuffer buffer{};
    for (std::size_t j = 0; j < Panda::dimension; ++j) buffer[j] = q[j];
    const auto start = std::chrono::steady_clock::now();
    const Panda::Configuration configuration(buffer.data());
    free[i] = vamp::planning::validate_motion<Panda, kRake, 1>(
        configuration, configuration, *static_cast<const Environment*>(environment));
    seconds[i] = seconds_since(start);
  }
}

/// The same with as many configurations in a call as there are lanes, as along a planner's edge:
/// whether all of them are free.
void capt_validate_lanes(const void* environment, const float* q, int calls, unsigned char* free,
                         double* seconds) {
  for (int i = 0; i < calls; ++i, q += kRake * Panda::dimension) {
    Panda::ConfigurationBlock<kRake> block;
    for (std::size_t j = 0; j < Panda::dimension; ++j) {
      alignas(64) float lanes[kRake];
      for (std::size_t lane = 0; lane < kRake; ++lane) lanes[lane] = q[lane * Panda::dimension + j];
      block[j] = vamp::FloatVector<kRake>(lanes);
    }
    const auto start = std::chrono::steady_clock::now();
    free[i] = Panda::fkcc<kRake>(*static_cast<const Environment*>(environment), block);
    seconds[i] = seconds_since(start);
  }
}

int capt_lanes() { return static_cast<int>(kRake); }

}  // extern "C"
#pragma GCC visibility pop
