#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/frame.hpp"
#include "hulls/hull_model.hpp"
#include "simd/cull.hpp"

namespace pdoik::detail {

/// The capsules of hulls where they are, in single precision: made when first asked for.
class CapsuleQueries {
 public:
  explicit CapsuleQueries(const std::vector<Hull>& hulls) : of_(hulls.size()) {
    std::size_t most = 0;
    for (std::size_t h = 0; h < hulls.size(); ++h) {
      of_[h].first = most;
      most += 4U * static_cast<std::size_t>(hulls[h].blocks);
    }
    queries_.resize(most);
  }

  /// Hulls are elsewhere now.
  void forget() { ++placed_; }

  /// Those of hull h, whose body is at a frame, relative to an origin.
  std::span<const CapsuleQuery> of(std::size_t h, std::span<const CapsuleBlock> blocks,
                                   const Frame& frame, const Vec4& origin) {
    Of& own = of_[h];
    if (own.placed != placed_ || own.origin[0] != origin[0] || own.origin[1] != origin[1] ||
        own.origin[2] != origin[2]) {
      own.placed = placed_;
      own.origin = origin;
      own.count = 0;
      for (const CapsuleBlock& block : blocks)
        for (int lane = 0; lane < 4; ++lane) add(block, lane, frame, own);
    }
    return {queries_.data() + own.first, own.count};
  }

 private:
  struct Of {
    std::size_t first = 0, count = 0;
    std::uint64_t placed = 0;  ///< when they were made
    Vec4 origin{};
  };

  void add(const CapsuleBlock& block, int lane, const Frame& frame, Of& own) {
    if (block.source[lane] < 0) return;  // padding
    const Vec4 a = transform(frame, Vec4{block.ax[lane], block.ay[lane], block.az[lane], 0.0}) -
                   own.origin,
               v = rotate(frame, Vec4{block.vx[lane], block.vy[lane], block.vz[lane], 0.0});
    CapsuleQuery& query = queries_[own.first + own.count++];
    for (int i = 0; i < 3; ++i) {
      query.a[i] = static_cast<float>(a[i]);
      query.v[i] = static_cast<float>(v[i]);
    }
    query.inverse = static_cast<float>(block.inverse[lane]);
    query.radius = static_cast<float>(block.radius[lane]);
  }

  std::vector<Of> of_;
  std::vector<CapsuleQuery> queries_;
  std::uint64_t placed_ = 1;
};

}  // namespace pdoik::detail
