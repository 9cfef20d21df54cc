#include <pybind11/stl.h>

#include "bind.hpp"
#include "cloud.hpp"
#include "pdoik/point_cloud.hpp"
#include "without_gil.hpp"

namespace pdoik::python {
namespace {

/// Calls take(points) with what thinning leaves, or with the points themselves.
template <class Take>
auto thinned(const PointsView& points, const std::optional<Thinning>& thinning,
             const InteriorSphereOptions& sink, Take&& take) {
  if (!thinning && sink.viewpoints.rows() > 0) throw std::invalid_argument(kNotSolid);
  if (!thinning) return points.is_single() ? take(points.in_single()) : take(points.in_double());
  const RowMatrix cast =
      points.is_single() ? RowMatrix(points.in_single().cast<double>()) : RowMatrix();
  const Obstacles all = points.is_single() ? Obstacles(cast) : points.in_double();
  const RowMatrix kept = thin(all, *thinning, sink);
  if (kept.rows() == 0 && all.rows() > 0) {
    throw std::invalid_argument("points has " + std::to_string(all.rows()) +
                                " rows, each with NaN or infinity: a camera that saw nothing, "
                                "perhaps, which does not say that nothing is there");
  }
  return take(Obstacles(kept));
}

std::optional<Thinning> to_thinning(const std::optional<double>& leaf, bool radii, bool solid) {
  if (leaf) return Thinning{*leaf, radii, solid};
  if (radii || solid)
    throw std::invalid_argument(std::string(solid ? "solid" : "radii") +
                                " is about balls of a leaf's cells, and there is no leaf");
  return std::nullopt;
}

/// Centres of interior spheres lie elsewhere than their points, so that a region's balls are not
/// those of a region's points.
void check_part(const ThinnedCloud& cloud, const Eigen::AlignedBox3d& region) {
  if (!cloud.thinning || !cloud.thinning->solid) return;
  const auto points = cloud.cloud.points();
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (region.contains(points.row(i).head<3>().transpose())) continue;
    throw std::invalid_argument(
        "region leaves out a part of a solid cloud, which is changed as a whole only");
  }
}

Eigen::AlignedBox3d to_region(const ArrayLike& values) {
  const Array array = to_float64(values, "region");
  if (array.ndim() != 2 || array.shape(0) != 2 || array.shape(1) != 3) {
    throw std::invalid_argument("region has shape " + std::string(py::str(array.attr("shape"))) +
                                ", expected (2, 3): its lowest and highest x, y, z");
  }
  const Eigen::Map<const Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> corners(array.data());
  return {Eigen::Vector3d(corners.row(0)), Eigen::Vector3d(corners.row(1))};
}

}  // namespace

void bind_cloud(py::module_& module) {
  py::class_<ThinnedCloud>(
      module, "Cloud",
      R"(Obstacle points that are taken in once, for any number of solves and solvers.

The points are put in the order of the cells that they lie in, with boxes around neighbours, so that a solve
among a million looks at few of them. Give it as `obstacles` wherever points go.

A solve sees the cloud as it is when it begins, for an update makes another one beside it: no solve waits for an
update and no update for a solve. Any number of threads may solve and update at once; updates take turns. A cloud
that has been updated takes twice the memory, and once more for each older one that is still solved among.

>>> import numpy as np
>>> import pdoik
>>> rng = np.random.default_rng(0)
>>> cloud = pdoik.Cloud(rng.uniform(-1, 1, (100_000, 3)) + [0, 0, 3])
>>> robot = pdoik.Robot.builtin("panda")
>>> solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
>>> solver.solve(robot.fk(robot.mid_configuration()), obstacles=cloud).success
True
>>> cloud.remove([[-1, -1, 2], [1, 1, 3]]) > 40_000
True)")
      .def(py::init([](const ArrayLike& points, const std::optional<double>& leaf, bool radii,
                       bool solid, const std::optional<ArrayLike>& viewpoint) {
             const std::optional<Thinning> thinning = to_thinning(leaf, radii, solid);
             const PointsView view(points, "points");
             const Points viewpoints = to_viewpoints(viewpoint);
             const WithoutGil release;
             return ThinnedCloud{thinned(view, thinning, {.viewpoints = viewpoints},
                                         [](const auto& rows) { return Cloud(rows); }),
                                 thinning};
           }),
           py::arg("points"), py::arg("leaf") = py::none(), py::arg("radii") = false,
           py::arg("solid") = false, py::arg("viewpoint") = py::none(),
           R"(Take points in.

Args:
    points: x y z, or x y z radius, in the base frame, shape (N, 3) or (N, 4) [m]. Float32 and float64 are
        read without a conversion where a row's numbers lie side by side. With no rows: a cloud to be updated.
        Or as a depth camera has them, (H, W, 3): pixels with NaN or infinity are left out, but not all.
    leaf: Thin the points out first: one, the mean, for each cell of a grid with this edge [m], see
        voxel_downsample; rows with NaN or infinity are then left out, but not all of them. None keeps all.
    radii: Give each kept point the radius of a ball such that the balls hold every point there was.
    solid: The points are the surface of solid things: sink these balls into them, see voxel_downsample.
    viewpoint: Of a solid cloud, where it was seen from, shape (3,), or (N, 3) for each point [m].

Raises:
    ValueError: The shape is wrong, a number is NaN, infinite or beyond 1e6, a radius is negative (naming the
        row), there are more than 33,554,432 points, or nothing is left of them to thin out.)")
      .def("__len__", [](const ThinnedCloud& self) { return self.cloud.size(); })
      .def(
          "update",
          [](ThinnedCloud& self, const ArrayLike& points, const ArrayLike& region,
             const std::optional<ArrayLike>& viewpoint) {
            const PointsView view(points, "points");
            const Eigen::AlignedBox3d box = to_region(region);
            const Points viewpoints = to_viewpoints(viewpoint);
            const WithoutGil release;
            check_part(self, box);
            return thinned(view, self.thinning, {.viewpoints = viewpoints, .within = box},
                           [&](const auto& rows) { return self.cloud.update(rows, box); });
          },
          py::arg("points"), py::arg("region"), py::arg("viewpoint") = py::none(),
          R"(Put points in place of all those in a region, at twice the cost of what changes.

The first time, where much changes, and while an older one is still solved among, it copies all.

Args:
    points: As in the constructor, thinned out as the cloud was; all within the region. No ball of a
        solid cloud sinks out of it.
    region: An axis-aligned box, shape (2, 3): its lowest and its highest x, y, z [m].
    viewpoint: Of a solid cloud, as in the constructor.

Returns:
    How many points there were in the region.

Raises:
    ValueError: As the constructor; a region that is inside out or no number, or leaves out a part of a solid
        cloud, whose balls are not where its points are; a point outside of it. The cloud is then as before.)")
      .def(
          "remove",
          [](ThinnedCloud& self, const ArrayLike& region) {
            const Eigen::AlignedBox3d box = to_region(region);
            const WithoutGil release;
            check_part(self, box);
            return self.cloud.remove(box);
          },
          py::arg("region"),
          R"(Take out the points in a region, as in `update`.

Returns:
    How many there were.

Raises:
    ValueError: A region that is inside out or no number, or leaves out a part of a solid cloud.)")
      .def_property_readonly(
          "points", [](const ThinnedCloud& self) { return self.cloud.points(); },
          "A copy of the points, x y z radius, shape (N, 4) [m], in the cloud's own order.")
      .def_property_readonly(
          "ids",
          [](const ThinnedCloud& self) {
            const std::vector<int> ids = self.cloud.ids();
            return py::array_t<int>(static_cast<py::ssize_t>(ids.size()), ids.data());
          },
          R"(What results call each of `points`, shape (N,).

A point's row when it was taken in, numbered on with each update.)")
      .def_property_readonly(
          "nbytes", [](const ThinnedCloud& self) { return self.cloud.bytes(); },
          "The memory that the points take, with those of older ones that are kept [bytes].")
      .def("__repr__", [](const ThinnedCloud& self) {
        return py::str("<Cloud of {} points, {:.3g} MB>")
            .format(self.cloud.size(), 1e-6 * static_cast<double>(self.cloud.bytes()));
      });
}

}  // namespace pdoik::python
