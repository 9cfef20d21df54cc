#include "mesh_arrays.hpp"

#include <limits>
#include <stdexcept>

namespace pdoik::python {

std::vector<Eigen::Vector3d> to_vertices(const ArrayLike& values) {
  const Array array = to_float64(values, "vertices");
  if (array.ndim() != 2 || array.shape(1) != 3)
    throw std::invalid_argument("vertices has another shape than (N, 3)");
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>> rows(
      array.data(), array.shape(0), 3);
  std::vector<Eigen::Vector3d> vertices;
  vertices.reserve(static_cast<std::size_t>(rows.rows()));
  for (Eigen::Index i = 0; i < rows.rows(); ++i) vertices.emplace_back(rows.row(i).transpose());
  return vertices;
}

std::vector<std::array<int, 3>> to_triangles(const ArrayLike& values) {
  const auto array = py::array::ensure(values.value);
  if (!array || array.ndim() != 2 || array.shape(1) != 3 ||
      std::string("iu").find(array.dtype().kind()) == std::string::npos)
    throw std::invalid_argument("triangles is no array of whole numbers of shape (T, 3)");
  const auto numbers = array.cast<py::array_t<std::int64_t, py::array::c_style>>();
  const auto at = numbers.unchecked<2>();
  std::vector<std::array<int, 3>> triangles(static_cast<std::size_t>(at.shape(0)));
  for (py::ssize_t i = 0; i < at.shape(0); ++i) {
    for (py::ssize_t k = 0; k < 3; ++k) {
      // What is no int is no vertex's place either.
      const bool fits = at(i, k) >= 0 && at(i, k) <= std::numeric_limits<int>::max();
      triangles[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] =
          fits ? static_cast<int>(at(i, k)) : -1;
    }
  }
  return triangles;
}

}  // namespace pdoik::python
