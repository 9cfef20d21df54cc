#include "obstacles/obstacle_set.hpp"

#include <cmath>
#include <utility>

namespace pdoik::detail {
namespace {

constexpr int kGroup = kLanes * kLanes;  // points
constexpr float kFarAway = 1e15F;  // squares and their products stay finite in single precision

template <class Integer>
Integer round_up(Integer count) {
  constexpr auto lanes = static_cast<Integer>(kLanes);
  return (count + lanes - 1) / lanes * lanes;
}

}  // namespace

void ObstacleSet::reserve(std::size_t count) {
  const std::size_t padded = round_up(count);
  points_.reserve(padded);
  index_.reserve(padded);
  for (LargeVector<float>* v : {&coarse_x_, &coarse_y_, &coarse_z_, &coarse_radius_})
    v->reserve(padded);
  if (count <= static_cast<std::size_t>(kGroup)) return;
  const std::size_t groups = padded / kGroup + 1;
  districts_.reserve(groups / kLanes + 1);
  groups_.reserve(groups + kLanes);
  blocks_.reserve((groups + kLanes) * kLanes);
  if (few_ == nullptr) few_ = std::make_unique<ObstacleSet>();
  few_->reserve(padded / kLanes + 1);
}

void ObstacleSet::copy(const ObstacleSet& other) {
  const auto take = [](auto& own, const auto& theirs) {
    own.reserve(theirs.capacity());
    own = theirs;
  };
  take(points_, other.points_);
  take(index_, other.index_);
  take(coarse_x_, other.coarse_x_);
  take(coarse_y_, other.coarse_y_);
  take(coarse_z_, other.coarse_z_);
  take(coarse_radius_, other.coarse_radius_);
  for (const auto& [own, theirs] : {std::pair{&blocks_, &other.blocks_},
                                    {&groups_, &other.groups_},
                                    {&districts_, &other.districts_}}) {
    for (int axis = 0; axis < 3; ++axis) {
      take(own->low[axis], theirs->low[axis]);
      take(own->high[axis], theirs->high[axis]);
    }
    take(own->radius, theirs->radius);
    own->count = theirs->count;
    own->padded = theirs->padded;
  }
  if (other.few_ != nullptr) {
    if (few_ == nullptr) few_ = std::make_unique<ObstacleSet>();
    few_->copy(*other.few_);
  }
  changed_ = other.changed_;
  origin_ = other.origin_;
  count_ = other.count_;
  places_ = other.places_;
  padded_ = other.padded_;
  next_id_ = other.next_id_;
  extent_ = other.extent_;
  in_order_ = other.in_order_;
}

void ObstacleSet::begin(int count, const Eigen::Vector3d& origin) {
  const auto size = static_cast<std::size_t>(round_up(count));
  points_.resize(size);
  index_.resize(size);
  for (LargeVector<float>* v : {&coarse_x_, &coarse_y_, &coarse_z_, &coarse_radius_})
    v->resize(size);
  origin_ = to_vec4(origin);
  count_ = places_ = next_id_ = 0;
  extent_ = 1.0;
  changed_.clear();
}

void ObstacleSet::put(int place, double x, double y, double z, double radius, int id) {
  const auto k = static_cast<std::size_t>(place);
  points_[k] = Vec4{x, y, z, radius};
  index_[k] = id;
  coarse_x_[k] = static_cast<float>(x - origin_[0]);
  coarse_y_[k] = static_cast<float>(y - origin_[1]);
  coarse_z_[k] = static_cast<float>(z - origin_[2]);
  // A negative radius lets a point into a hull by its distance from the surface, which reaches
  // deeper than a smaller spheroid's border does: the coarse test takes the hull as it is.
  coarse_radius_[k] = radius > 0.0 ? static_cast<float>(radius) : 0.0F;
}

void ObstacleSet::clear(int place) {
  const auto k = static_cast<std::size_t>(place);
  coarse_x_[k] = coarse_y_[k] = coarse_z_[k] = kFarAway;
  coarse_radius_[k] = 0.0F;
  index_[k] = -1;
}

void ObstacleSet::pad() {
  padded_ = round_up(places_);
  for (int k = places_; k < padded_; ++k) clear(k);
}

void ObstacleSet::finish(bool in_order) {
  places_ = count_;
  next_id_ = count_;
  in_order_ = in_order && count_ > kGroup;
  pad();
  resize_boxes();
  if (in_order_) {
    for (int b = 0; b < blocks_.count; ++b) box_block(b);
    for (int g = 0; g < groups_.count; ++g) box_group(g);
    for (int d = 0; d < districts_.count; ++d) box_district(d);
    if (few_ == nullptr) few_ = std::make_unique<ObstacleSet>();
    few_->begin(blocks_.count, to_vector3(origin_));
    for (int b = 0; b < blocks_.count; ++b) {
      const int first = b * kLanes, k = first + std::min(kLanes, count_ - first) / 2;
      few_->add((*this)[k], id(k));
    }
    few_->finish(true);
  }
  measure_extent();
}

void ObstacleSet::measure_extent() {
  float extent = 1.0F;
  if (in_order_) {
    for (int d = 0; d < districts_.count; ++d) {
      const auto at = static_cast<std::size_t>(d);
      for (int axis = 0; axis < 3 && districts_.low[axis][at] < kFarAway; ++axis) {
        extent = std::max(
            {extent, std::abs(districts_.low[axis][at]), std::abs(districts_.high[axis][at])});
      }
      extent = std::max(extent, districts_.radius[at]);
    }
  } else {
    for (std::size_t k = 0; k < static_cast<std::size_t>(places_); ++k) {
      if (index_[k] < 0) continue;
      extent = std::max({extent, std::abs(coarse_x_[k]), std::abs(coarse_y_[k]),
                         std::abs(coarse_z_[k]), coarse_radius_[k]});
    }
  }
  extent_ = static_cast<double>(extent);
}

void ObstacleSet::Boxes::reserve(std::size_t boxes) {
  const std::size_t size = round_up(boxes);
  for (std::vector<float>* v : {&low[0], &low[1], &low[2], &high[0], &high[1], &high[2], &radius})
    v->reserve(size);
}

void ObstacleSet::Boxes::resize(int boxes) {
  count = boxes;
  padded = round_up(boxes);
  const auto size = static_cast<std::size_t>(padded);
  for (std::vector<float>* v : {&low[0], &low[1], &low[2], &high[0], &high[1], &high[2]})
    v->resize(size);
  radius.resize(size);
  for (auto b = static_cast<std::size_t>(boxes); b < size; ++b) {
    for (int axis = 0; axis < 3; ++axis) low[axis][b] = high[axis][b] = kFarAway;
    radius[b] = 0.0F;
  }
}

void ObstacleSet::Boxes::enclose(int b, const Boxes& inner, int first, int end) {
  const auto at = static_cast<std::size_t>(b);
  for (int axis = 0; axis < 3; ++axis) {
    // Boxes of nothing lie far away, and count only where there is nothing else.
    float least = kFarAway, most = -kFarAway;
    for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(end); ++k) {
      if (inner.low[axis][k] == kFarAway) continue;
      least = std::min(least, inner.low[axis][k]);
      most = std::max(most, inner.high[axis][k]);
    }
    low[axis][at] = least;
    high[axis][at] = least == kFarAway ? kFarAway : most;
  }
  radius[at] = *std::max_element(inner.radius.data() + first, inner.radius.data() + end);
}

void ObstacleSet::resize_boxes() {
  const int blocks = in_order_ ? padded_ / kLanes : 0;
  const int groups = (blocks + kLanes - 1) / kLanes;
  blocks_.resize(blocks);
  groups_.resize(groups);
  districts_.resize((groups + kLanes - 1) / kLanes);
}

void ObstacleSet::box_block(int block) {
  const float* const coordinate[] = {coarse_x_.data(), coarse_y_.data(), coarse_z_.data()};
  const int first = block * kLanes, end = first + kLanes;
  const auto at = static_cast<std::size_t>(block);
  for (int axis = 0; axis < 3; ++axis) {
    const float* const v = coordinate[axis];
    float low = kFarAway, high = -kFarAway;
    for (int k = first; k < end; ++k) {
      low = std::min(low, v[k]);  // places without a point lie far away
      high = std::max(high, v[k] == kFarAway ? -kFarAway : v[k]);
    }
    blocks_.low[axis][at] = low;
    blocks_.high[axis][at] = low == kFarAway ? kFarAway : high;
  }
  blocks_.radius[at] =
      *std::max_element(coarse_radius_.data() + first, coarse_radius_.data() + end);
}

void ObstacleSet::box_group(int g) {
  groups_.enclose(g, blocks_, g * kLanes, std::min((g + 1) * kLanes, blocks_.count));
}

void ObstacleSet::box_district(int d) {
  districts_.enclose(d, groups_, d * kLanes, std::min((d + 1) * kLanes, groups_.count));
}

void ObstacleSet::grow_to(int places) {
  const auto size = static_cast<std::size_t>(round_up(places));
  points_.resize(size);
  index_.resize(size);
  for (LargeVector<float>* v : {&coarse_x_, &coarse_y_, &coarse_z_, &coarse_radius_})
    v->resize(size);
  const int before = places_;
  places_ = places;
  padded_ = round_up(places);
  for (int k = before; k < padded_; ++k) clear(k);
  resize_boxes();
}

void ObstacleSet::replace(int place, const ObstacleSet& source, int source_place) {
  if (holds(place)) --count_;
  if (source_place < 0) {
    clear(place);
    return;
  }
  ++count_;
  put(place, source[source_place], source.id(source_place));
}

void ObstacleSet::refit(const std::vector<int>& changed) {
  if (!in_order_) {
    measure_extent();
    return;
  }
  const auto for_each_of = [&](int size, const auto& visit) {
    int last = -1;
    for (const int b : changed) {
      if (b / size == last) continue;
      last = b / size;
      visit(last);
    }
  };
  for_each_of(1, [&](int b) { box_block(b); });
  for_each_of(kLanes, [&](int g) { box_group(g); });
  for_each_of(kLanes * kLanes, [&](int d) { box_district(d); });
  if (few_->places() < blocks_.count) few_->grow_to(blocks_.count);
  std::vector<int> changed_few;  // blocks of them
  for (const int b : changed) {
    const int first = b * kLanes, size = std::min(kLanes, places_ - first);
    int chosen = -1;
    for (int k = 0; k < size && chosen < 0; ++k) {  // the middle one, or the next that there is
      const int place = first + (size / 2 + k) % size;
      if (holds(place)) chosen = place;
    }
    few_->replace(b, *this, chosen);
    if (changed_few.empty() || changed_few.back() != b / kLanes) changed_few.push_back(b / kLanes);
  }
  few_->refit(changed_few);
  measure_extent();
}

template <class Visit>
void ObstacleSet::for_blocks_in(const Eigen::AlignedBox3f& box, Visit&& visit) const {
  const auto meets = [&](const Boxes& boxes, int b) {
    const auto at = static_cast<std::size_t>(b);
    for (int axis = 0; axis < 3; ++axis) {
      if (boxes.low[axis][at] > box.max()[axis] || boxes.high[axis][at] < box.min()[axis])
        return false;
    }
    return true;
  };
  for (int d = 0; d < districts_.count; ++d) {
    if (!meets(districts_, d)) continue;
    for (int g = d * kLanes; g < std::min((d + 1) * kLanes, groups_.count); ++g) {
      if (!meets(groups_, g)) continue;
      for (int b = g * kLanes; b < std::min((g + 1) * kLanes, blocks_.count); ++b)
        if (meets(blocks_, b)) visit(b);
    }
  }
}

int ObstacleSet::remove(const Eigen::AlignedBox3d& region) {
  const int before = count_;
  changed_.clear();
  const auto remove_from = [&](int first, int end) {
    const int had = count_;
    for (int k = first; k < end; ++k) {
      if (!holds(k) || !region.contains(to_vector3((*this)[k]))) continue;
      clear(k);
      --count_;
    }
    return count_ < had;
  };
  if (!in_order_) {
    remove_from(0, places_);
    return before - count_;
  }
  // Single precision: a little wider than the region itself.
  const Eigen::Vector3d wider = Eigen::Vector3d::Constant(1e-6 * extent_),
                        origin = to_vector3(origin_);
  const Eigen::AlignedBox3f box((region.min() - origin - wider).cast<float>(),
                                (region.max() - origin + wider).cast<float>());
  for_blocks_in(box, [&](int b) {
    if (remove_from(b * kLanes, std::min((b + 1) * kLanes, places_))) changed_.push_back(b);
  });
  refit(changed_);
  return before - count_;
}

int ObstacleSet::remove(std::vector<int> places) {
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  changed_.clear();
  for (const int place : places) {
    clear(place);
    if (changed_.empty() || changed_.back() != place / kLanes) changed_.push_back(place / kLanes);
  }
  count_ -= static_cast<int>(places.size());
  refit(changed_);
  return static_cast<int>(places.size());
}

bool ObstacleSet::insert(std::span<const Vec4> points, CellOrder& order) {
  const auto holes_in = [&](int b) {
    const int first = b * kLanes, end = std::min(first + kLanes, places_);
    return std::count_if(index_.begin() + first, index_.begin() + end,
                         [](int id) { return id < 0; });
  };
  auto left = static_cast<std::ptrdiff_t>(points.size());
  for (const int b : changed_) left -= holes_in(b);
  const auto places = static_cast<std::size_t>(places_) +
                      static_cast<std::size_t>(std::max<std::ptrdiff_t>(left, 0));
  if (!in_order_ || round_up(places) > points_.capacity()) return false;

  const auto point = [&](int row) { return points[static_cast<std::size_t>(row)]; };
  const int count = static_cast<int>(points.size());
  if (count > 0) order.begin(count, point);
  for (int row = 0; row < count; ++row) order.add(point(row));
  const auto sorted = count > 0 ? order.sorted() : std::span<const CellOrder::Entry>();
  int k = 0;
  const auto put_next = [&](int place) {
    const int row = sorted[static_cast<std::size_t>(k++)].row;
    put(place, point(row), next_id_ + row);
  };
  for (const int b : changed_) {
    for (int place = b * kLanes; place < std::min((b + 1) * kLanes, places_) && k < count; ++place)
      if (!holds(place)) put_next(place);
  }
  if (k < count) {
    const int first = places_;
    grow_to(first + count - k);
    for (int place = first; place < places_; ++place) put_next(place);
    const int first_block = first / kLanes;
    if (!changed_.empty() && changed_.back() == first_block) changed_.pop_back();
    for (int b = first_block; b * kLanes < places_; ++b) changed_.push_back(b);
  }
  count_ += count;
  next_id_ += count;
  refit(changed_);
  changed_.clear();
  return true;
}

int ObstacleSet::count_within(const Eigen::Vector3d& centre, double radius) const {
  int within = 0;
  if (!in_order_) {
    for (int k = 0; k < places_; ++k) {
      if (!holds(k)) continue;
      const Vec4& o = (*this)[k];
      if ((to_vector3(o) - centre).norm() <= radius + 2.0 * o[3]) ++within;
    }
    return within;
  }
  const Eigen::Vector3d c = centre - to_vector3(origin_);
  for (int g = 0; g < groups_.count; ++g) {
    const auto at = static_cast<std::size_t>(g);
    double square = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double off =
          std::max({groups_.low[axis][at] - c[axis], c[axis] - groups_.high[axis][at], 0.0});
      square += off * off;
    }
    const double reach = radius + 2.0 * groups_.radius[at] + 1e-6 * extent_;
    if (square <= reach * reach) within += std::min(kGroup, places_ - g * kGroup);
  }
  return within;
}

std::size_t ObstacleSet::bytes() const {
  const auto of_boxes = [](const Boxes& boxes) {
    return 7 * sizeof(float) * boxes.radius.capacity();
  };
  return points_.capacity() * (sizeof(Vec4) + 4 * sizeof(float) + sizeof(int)) + of_boxes(blocks_) +
         of_boxes(groups_) + of_boxes(districts_) + (few_ != nullptr ? few_->bytes() : 0);
}

}  // namespace pdoik::detail
