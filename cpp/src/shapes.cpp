#include "pdoik/shapes.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <stdexcept>

#include "detail/shape_parts.hpp"
#include "detail/shape_set.hpp"

namespace pdoik {

namespace detail {

ShapeSet::ShapeSet(std::vector<Shape> shapes_in, std::vector<AllowedContact> allowed_in)
    : shapes(std::move(shapes_in)), allowed(std::move(allowed_in)) {
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    std::ranges::move(parts_of(shapes[k]), std::back_inserter(parts));
    owners.resize(parts.size(), static_cast<int>(k));
  }
  tree = ShapeTree(parts);
  has_surfaces = std::ranges::any_of(parts, &Solid::is_surface);
  for (const Solid& part : parts) steepest = std::max(steepest, part.steepest());
}

std::shared_ptr<const ShapeSet> no_shapes() {
  static const auto none = std::make_shared<const ShapeSet>();
  return none;
}

}  // namespace detail

Shapes::Shapes() : set_(detail::no_shapes()) {}

Shapes::Shapes(std::vector<Shape> shapes, std::vector<AllowedContact> allowed) {
  auto set = std::make_shared<detail::ShapeSet>(std::move(shapes), std::move(allowed));
  std::set<std::string> names;
  for (const Shape& shape : set->shapes) {
    if (!names.insert(shape.name).second)
      throw std::invalid_argument("two shapes are called '" + shape.name + "'");
  }
  for (const AllowedContact& contact : set->allowed) {
    if (!names.contains(contact.shape))
      throw std::invalid_argument("contact is allowed with '" + contact.shape +
                                  "', which is no shape's name");
    if (!(contact.depth >= 0.0)) {
      throw std::invalid_argument("'" + contact.link + "' may touch '" + contact.shape +
                                  "' to a depth of " + std::to_string(contact.depth) +
                                  ", expected at least 0 [m]");
    }
  }
  set_ = std::move(set);
}

std::span<const Shape> Shapes::shapes() const { return set_->shapes; }
std::span<const AllowedContact> Shapes::allowed() const { return set_->allowed; }

}  // namespace pdoik
