#pragma once

#include "simd/roll_out.hpp"

namespace pdoik::detail {

// Many least-squares searches at once, one in each lane of a vector register: the same arithmetic
// in every lane, so that what a lane finds does not depend on what the others do.
//
// A row is one number of each lane: `width` doubles side by side, aligned to kRowAlignment bytes.

constexpr int kRowAlignment = 32;
constexpr int kGoalRows = 18;  ///< that a goal's errors take

/// What one tip is asked: the same kind of goal in all lanes, a target in each.
struct LaneGoal {
  bool turns;      ///< whether the tip's rotation, or that of one axis, is asked for
  bool by_axis;    ///< of one axis
  bool yields;     ///< whether rotation counts in some lanes only, see `turning`
  bool looks;      ///< which points at the target's origin, wherever the tip is
  bool is_placed;  ///< whether the tip's position is asked for
  bool has_slack;
  double position_tolerance2, rotation_tolerance2;  ///< squared [m^2], [rad^2]
  const int* chain;  ///< bodies from the tip's to the base, which is left out
  int chain_length;
  /// The same of the body that the target moves with; none where it stands still.
  const int* reference_chain;
  int reference_chain_length;
  const int* dofs;  ///< those that move them, each once, ascending
  int dof_count;
  Frame T_body_tip;
  Vec4 axis;             ///< in the tip frame, where by_axis
  double* target;        ///< 12 rows: axes x, y, z and origin in the base frame
  double* in_reference;  ///< 12 rows: the same in its body's frame, where that moves
  double* slack;         ///< 6 rows: of the position, of the rotation, along the target's axes
  double* weight;        ///< 1 row
  double* turning;       ///< 1 row: 1 where rotation counts, else 0; read where it `yields`
};

/// A state of a lane, held as a double.
enum class LaneState { Idle, Running, Done, Stalled, IterationLimit };

/// Levenberg and Marquardt's method with an active set (see LevenbergMarquardt) in every lane.
struct LaneProblem {
  const RolloutJoint* joints;
  /// Where a body's fixed axes x, y, z lie along one of its parent's, that axis: 1, 2, 3, or its
  /// negative; else 0.
  const signed char (*onto)[3];
  int bodies, dof;
  LaneGoal* goals;
  int goal_count;
  double rotation_weight;  ///< [m/rad]
  int max_iterations;
  double first_damping, damping_decrease, damping_increase, max_damping;

  double *lower, *upper, *x, *trial, *gradient;  ///< dof rows
  double* hessian;                               ///< dof (dof + 1) / 2 rows: (i, k <= i) by i
  double *state, *value, *damping, *scale, *reference, *since_reference;  ///< a row each
  double *stall_ratio, *stall_window, *iterations, *evaluations;
  double* fresh;  ///< whether a lane's trial is its start

  double* frames;   ///< scratch: 12 rows a body
  double* columns;  ///< 6 rows a dof
  double* errors;   ///< kGoalRows a goal
  double *factor, *step, *is_free;
};

/// One evaluation and one step in each lane that runs.
/// @returns  A bit for each lane whose search has ended in it.
using LaneTick = unsigned (*)(const LaneProblem& problem);

unsigned lane_tick_baseline(const LaneProblem&);
unsigned lane_tick_avx2(const LaneProblem&);

struct LaneKernel {
  LaneTick tick;
  int width;  ///< lanes of a row
};
/// The widest of the level that best_coarse chooses by.
LaneKernel best_lane_kernel();

}  // namespace pdoik::detail
