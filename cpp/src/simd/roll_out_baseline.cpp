#include "simd/roll_out.hpp"

namespace pdoik::detail {

void roll_out_baseline(const RolloutJoint* joints, int count, const double* cosine,
                       const double* sine, const double* q, Frame* frames) {
#include "simd/roll_out_body.inl"
}

}  // namespace pdoik::detail
