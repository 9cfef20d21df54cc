#include <pybind11/stl.h>

#include "arrays.hpp"
#include "bind.hpp"
#include "thinning.hpp"
#include "without_gil.hpp"

namespace pdoik::python {

void bind_point_cloud(py::module_& module) {
  module.def(
      "voxel_downsample",
      [](const ArrayLike& points, double leaf, bool radii, bool solid,
         const std::optional<ArrayLike>& viewpoint) {
        const PointsView cloud = PointsView::float64(points, "points");
        const Points viewpoints = to_viewpoints(viewpoint);
        const WithoutGil release;
        return thin(cloud, {leaf, radii, solid}, {.viewpoints = viewpoints});
      },
      py::arg("points"), py::arg("leaf"), py::arg("radii") = false, py::arg("solid") = false,
      py::arg("viewpoint") = py::none(),
      R"(Replace the points of each occupied cell of a grid by their mean (PCL's VoxelGrid).

The cells are cubes, one with a corner at the origin. PCL computes in float32: means are off by up to about
1 um per metre of the largest coordinate, and a point as near to a cell's wall may count for the neighbour.

Args:
    points: Shape (N, 3) [m]. Rows with NaN or infinity, as depth cameras give, are left out. Float64 in C
        order is read in place.
    leaf: Edge of the cells [m].
    radii: Also give each kept point the radius of a ball such that the balls hold every point of the cloud.
        Clearance is then kept to the cloud as it was, not only to the means.
    solid: The points are the surface of solid things. Each ball is sunk into them, by up to two leaves along
        the normal (PCL's, of the points within a leaf), and made large enough to hold the same points: of a
        flat surface it then stands an eighth of a leaf out, not seven tenths. Whatever is made of the cloud, its points
        stay in balls. A ball stays where it is where the normal is uncertain, or where nothing is won: thin
        sheets, sharp edges, single points.
    viewpoint: Of a solid cloud, where it was seen from, shape (3,), or (N, 3) for each point [m]. What lies
        behind a seen surface counts as solid. None: inside is what the cloud encloses, at cells of half a
        leaf. Its points should be no more than a third of a leaf apart, and what is open, like a box
        that nobody saw from below, encloses nothing and stays as it is.

Returns:
    The means, shape (K, 3) with K <= N, or (K, 4) with a radius in the fourth column [m]; of a solid cloud
    the balls' centres.

Raises:
    ValueError: The shape is wrong, leaf is not positive and finite, the cloud is so wide that the grid
        would have more than 2^31 cells, or viewpoint is NaN, of another shape, or given without solid.)");
}

}  // namespace pdoik::python
