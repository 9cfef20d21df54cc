#include "thinning.hpp"

namespace pdoik::python {

Points to_viewpoints(const std::optional<ArrayLike>& viewpoint) {
  if (!viewpoint) return Points(0, 3);
  const Array array = to_float64(*viewpoint, "viewpoint");
  const bool one = array.ndim() == 1 && array.shape(0) == 3;
  if (!one && !(array.ndim() == 2 && array.shape(1) == 3))
    throw std::invalid_argument("viewpoint has shape " + std::string(py::str(array.attr("shape"))) +
                                ", expected (3,), or (N, 3) with one for each point");
  return Eigen::Map<const Points>(array.data(), array.size() / 3, 3);
}

RowMatrix thin(const Obstacles& rows, const Thinning& thinning, const InteriorSphereOptions& sink) {
  const RowMatrix points = rows;  // which are read several times, and another thread's as well
  if (sink.viewpoints.rows() > 0 && !thinning.solid) throw std::invalid_argument(kNotSolid);
  const Points kept = voxel_downsample(points, thinning.leaf);
  if (thinning.solid) return interior_spheres(points, kept, thinning.leaf, sink);
  if (!thinning.radii) return kept;
  RowMatrix balls(kept.rows(), 4);
  balls << kept, covering_radii(points, kept, thinning.leaf);
  return balls;
}

}  // namespace pdoik::python
