#include "arrays.hpp"
#include "bind.hpp"
#include "pdoik/point_cloud.hpp"

namespace pdoik::python {

void bind_point_cloud(py::module_& module) {
  module.def(
      "voxel_downsample",
      [](const ArrayLike& points, double leaf, bool radii) {
        const PointsView cloud = PointsView::float64(points, "points");
        const py::gil_scoped_release release;
        const Points kept = voxel_downsample(cloud, leaf);
        RowMatrix result(kept.rows(), radii ? 4 : 3);
        result.leftCols<3>() = kept;
        if (radii) result.col(3) = covering_radii(cloud, kept, leaf);
        return result;
      },
      py::arg("points"), py::arg("leaf"), py::arg("radii") = false,
      R"(Replace the points of each occupied cell of a grid by their mean (PCL's VoxelGrid).

The cells are cubes, one with a corner at the origin. PCL computes in float32: means are off by up to about
1 um per metre of the largest coordinate, and a point as near to a cell's wall may count for the neighbour.

Args:
    points: Shape (N, 3) [m]. Rows with NaN or infinity, as depth cameras give, are left out. Float64 in C
        order is read in place.
    leaf: Edge of the cells [m].
    radii: Also give each kept point the radius of a ball such that the balls hold every point of the cloud.
        Clearance is then kept to the cloud as it was, not only to the means.

Returns:
    The means, shape (K, 3) with K <= N, or (K, 4) with a radius in the fourth column [m].

Raises:
    ValueError: The shape is wrong, leaf is not positive and finite, or the cloud is so wide that the grid
        would have more than 2^31 cells.)");
}

}  // namespace pdoik::python
