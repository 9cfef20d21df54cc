#pragma once

#include "simd/frame.hpp"

namespace pdoik::detail {

/// What moves a body: position = multiplier * q[dof] + offset about or along the body's z.
struct RolloutJoint {
  int parent, dof;
  bool prismatic;
  bool plain;  ///< turns by the angle of q[dof] itself, whose cosine and sine are given
  double multiplier, offset;
  Frame fixed;  ///< from the parent's frame, at position zero
};

/// Frames 1 to count - 1 from frame 0, each from its parent's (Algorithm FWD, lines 2 to 7).
using RollOutFunction = void (*)(const RolloutJoint* joints, int count, const double* cosine,
                                 const double* sine, const double* q, Frame* frames);

void roll_out_baseline(const RolloutJoint*, int, const double*, const double*, const double*,
                       Frame*);
void roll_out_avx2(const RolloutJoint*, int, const double*, const double*, const double*, Frame*);

/// The widest of the level that best_coarse chooses by.
RollOutFunction best_roll_out();

}  // namespace pdoik::detail
