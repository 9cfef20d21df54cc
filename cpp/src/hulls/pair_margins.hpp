#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "pdoik/contact_rule.hpp"
#include "pdoik/options.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// By how much farther than the options say two things have to keep off each other, by rules of
/// contact [m]: 0 for most, negative where they may come nearer, minus infinity where contact does
/// not count. Of a robot's links, what is attached, a scene's shapes, and its points.
class PairMargins {
 public:
  /// What moves: links by their places, what is attached by `of_attached`.
  using Mover = int;
  /// What a hull sits on: a link, or two.
  struct Seat {
    Mover one, other;
    Seat(Mover only) : one(only), other(only) {}  // NOLINT(google-explicit-constructor)
    Seat(Mover first, Mover second) : one(first), other(second) {}
  };
  /// The names of what there is.
  struct Things {
    std::vector<std::string> attached, shapes;
  };
  /// The rules of a scene, whose names are to be there, and those of what is attached, which count
  /// after them.
  struct Rules {
    std::span<const ContactRule> scene, attached;
    bool empty() const { return scene.empty() && attached.empty(); }
  };

  /// None.
  PairMargins() = default;
  /// Of a robot's links alone: of the pairs that it ignores contact does not count.
  explicit PairMargins(const Robot& robot);
  /// @throws std::invalid_argument  A rule of the scene that is not optional speaks of what is not
  /// there.
  PairMargins(const Robot& robot, const Options& options, const Things& things, const Rules& rules);

  /// A thing that is attached, by its place.
  Mover of_attached(int attached) const { return links_ + attached; }

  double between(const Seat& one, const Seat& other) const {
    if (movers_.empty()) return 0.0;
    return of_seat(one, [&](Mover a) {
      return of_seat(other, [&](Mover b) { return at(movers_, a, count_, b); });
    });
  }
  double to_shape(const Seat& seat, int shape) const {
    if (shapes_.empty()) return 0.0;
    return of_seat(seat, [&](Mover a) { return at(shapes_, a, shape_count_, shape); });
  }
  double to_points(const Seat& seat) const {
    if (points_.empty()) return 0.0;
    return of_seat(seat, [&](Mover a) { return at(points_, a, 1, 0); });
  }
  /// Whether anything is said of shapes, or of points.
  bool speak_of_shapes() const { return !shapes_.empty(); }
  bool speak_of_points() const { return !points_.empty(); }

  /// Whether any pair has a distance of its own, beside those whose contact does not count.
  bool have_own() const;
  /// The same without those.
  PairMargins without_own() const;
  /// Whether links keep off one another as by others.
  bool are_alike_of_links(const PairMargins& other) const;

 private:
  using Table = std::vector<double>;

  /// Of two links what lets come nearer, if either does; else what keeps off farther.
  template <class Of>
  double of_seat(const Seat& seat, Of&& of) const {
    const double one = of(seat.one);
    if (seat.one == seat.other) return one;
    const double other = of(seat.other);
    const double least = one < other ? one : other;
    return least < 0.0 ? least : one < other ? other : one;
  }
  double at(const Table& table, Mover row, int columns, int column) const {
    // What is attached is no row of a table of links alone.
    if (row >= count_ || column >= columns) return 0.0;
    return table[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                 static_cast<std::size_t>(column)];
  }
  void ignore_pairs(const Robot& robot);
  void set(Mover one, Mover other, double margin);

  int links_ = 0, count_ = 0, shape_count_ = 0;
  Table movers_, shapes_, points_;  ///< empty where nothing is said
};

}  // namespace pdoik::detail
