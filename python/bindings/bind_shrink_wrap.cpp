#include "arrays.hpp"
#include "bind.hpp"
#include "pdoik/shrink_wrap.hpp"
#include "without_gil.hpp"

namespace pdoik::python {
namespace {

CapsuleRows to_capsules(const ArrayLike& values) {
  const Array array = to_float64(values, "capsules");
  if (array.ndim() != 2 || array.shape(1) != 7)
    throw py::value_error("capsules has another shape than (K, 7)");
  return Eigen::Map<const CapsuleRows>(array.data(), array.shape(0), 7);
}

ShrinkWrap make_shrink_wrap(const ArrayLike& depth, const ArrayLike& origin, double edge,
                            const ArrayLike& points, double worst) {
  const Array grid = to_float64(depth, "depth");
  if (grid.ndim() != 3) throw py::value_error("depth has another shape than (X, Y, Z)");
  const Eigen::Vector3i shape(static_cast<int>(grid.shape(0)), static_cast<int>(grid.shape(1)),
                              static_cast<int>(grid.shape(2)));
  const Obstacles places = PointsView::float64(points, "points");
  if (places.cols() != 3) throw py::value_error("points has another shape than (P, 3)");
  return {{shape, to_vector3(origin, "origin"), edge,
           Eigen::Map<const Eigen::ArrayXd>(grid.data(), grid.size()).cast<float>()},
          places,
          worst};
}

}  // namespace

void bind_shrink_wrap(py::module_& module) {
  using W = ShrinkWrap;
  py::class_<W>(module, "ShrinkWrap",
                R"(Moves capsules so that they hold points and what sticks out of a solid is least.

Descends by Adam on an augmented Lagrangian of
    min  integral over the union, outside the solid, of f(distance)
    such that no point is outside the union,
f = 1 + (distance / worst)^6, which punishes what sticks out farthest. The integral's derivative is cheap
(Reynolds): where the union's free surface moves outwards by dn it grows by f dn dA. Capsules are rows of
their ends a and b and their radius, (K, 7) [m]. The same input gives the same result.)")
      .def(py::init(&make_shrink_wrap), py::kw_only(), py::arg("depth"), py::arg("origin"),
           py::arg("edge"), py::arg("points"), py::arg("worst"),
           R"(Args:
    depth: Of a grid's places below the surface, < 0 outside, (X, Y, Z) [m].
    origin: The first place [m].
    edge: Between neighbours [m].
    points: What is to be held, (P, 3) [m].
    worst: The distance from where f grows fast [m].

Raises:
    ValueError: A shape is wrong, an edge or worst is not positive, or something is NaN or infinite.)")
      .def(
          "move",
          [](const W& self, const ArrayLike& capsules, int steps) {
            const CapsuleRows rows = to_capsules(capsules);
            const WithoutGil without;
            return self.move(rows, steps);
          },
          py::arg("capsules"), py::arg("steps"),
          R"(The capsules after so many steps, (K, 7), which leave points outside by some tenths of a millimetre.

Raises:
    ValueError: A capsule is not finite or a radius not positive, as what follows does.)")
      .def(
          "outside_gradient",
          [](const W& self, const ArrayLike& capsules, double turn) {
            return self.outside_gradient(to_capsules(capsules), turn);
          },
          py::arg("capsules"), py::arg("turn") = 0.0,
          "The integral's derivative, (K, 7) [m^2], from 64 points on each capsule, which `turn` "
          "in [0, 1) shifts.")
      .def(
          "lack",
          [](const W& self, const ArrayLike& capsules, double multiplier, double rho) {
            return self.lack(to_capsules(capsules), multiplier, rho);
          },
          py::arg("capsules"), py::arg("multiplier"), py::arg("rho"),
          R"(The points' part of the Lagrangian, and its gradient, (K, 7): the sum over points of

    (max(0, multiplier + rho g)^2 - multiplier^2) / (2 rho),

g being how far each is outside the nearest capsule [m].)");
}

}  // namespace pdoik::python
