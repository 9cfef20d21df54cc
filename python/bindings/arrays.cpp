#include "arrays.hpp"

#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace pdoik::python {
namespace {

using ConstMatrix4 = Eigen::Map<const Matrix4>;

std::string shape_of(const py::array& array) { return py::str(array.attr("shape")); }

[[noreturn]] void fail_shape(const py::array& array, const std::string& name,
                             const std::string& expected) {
  throw std::invalid_argument(name + " has shape " + shape_of(array) + ", expected " + expected);
}

void require_finite(const Array& array, const std::string& name) {
  const Eigen::Map<const Eigen::ArrayXd> values(array.data(), array.size());
  if (!values.isFinite().all()) throw std::invalid_argument(name + " holds NaN or infinity");
}

Eigen::Isometry3d from_rows(const double* rows, const std::string& name) {
  const ConstMatrix4 matrix(rows);
  if (!matrix.row(3).isApprox(Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0), 1e-6)) {
    throw std::invalid_argument(name + " has a last row other than [0, 0, 0, 1]");
  }
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.matrix().topRows<3>() = matrix.topRows<3>();
  return result;
}

}  // namespace

Array to_float64(const ArrayLike& values, const std::string& name) {
  const auto array = py::array::ensure(values.value);
  if (!array)
    throw std::invalid_argument(name +
                                " is not an array of numbers: its rows differ in length, perhaps");
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u') {
    throw py::type_error(name + " has dtype " + std::string(py::str(array.dtype())) +
                         ", expected real numbers");
  }
  auto result = Array::ensure(array);
  if (!result) throw py::type_error(name + " cannot be converted to float64");
  return result;
}

Eigen::VectorXd to_vector(const ArrayLike& values, const std::string& name, Eigen::Index size) {
  const Array array = to_float64(values, name);
  if (array.ndim() != 1 || array.shape(0) != size)
    fail_shape(array, name, "(" + std::to_string(size) + ",)");
  require_finite(array, name);
  return Eigen::Map<const Eigen::VectorXd>(array.data(), size);
}

Eigen::Vector3d to_vector3(const ArrayLike& values, const std::string& name) {
  return to_vector(values, name, 3);
}

std::vector<Eigen::VectorXd> to_vectors(const ArrayLike& values, const std::string& name,
                                        Eigen::Index size) {
  const Array array = to_float64(values, name);
  if (array.ndim() == 1) return {to_vector(values, name, size)};
  if (array.ndim() != 2 || array.shape(1) != size) {
    const std::string n = std::to_string(size);
    fail_shape(array, name, "(" + n + ",) or (B, " + n + ")");
  }
  require_finite(array, name);
  std::vector<Eigen::VectorXd> result;
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    result.emplace_back(Eigen::Map<const Eigen::VectorXd>(array.data() + i * size, size));
  }
  return result;
}

Eigen::Isometry3d to_isometry(const ArrayLike& values, const std::string& name) {
  const Array array = to_float64(values, name);
  if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4)
    fail_shape(array, name, "(4, 4)");
  require_finite(array, name);
  return from_rows(array.data(), name);
}

std::vector<Eigen::Isometry3d> to_isometries(const ArrayLike& values, const std::string& name) {
  const Array array = to_float64(values, name);
  if (array.ndim() != 3 || array.shape(1) != 4 || array.shape(2) != 4)
    fail_shape(array, name, "(B, 4, 4)");
  require_finite(array, name);
  std::vector<Eigen::Isometry3d> result;
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    result.push_back(from_rows(array.data() + 16 * i, name + "[" + std::to_string(i) + "]"));
  }
  return result;
}

namespace {

/// Whether rows can be read where they are: numbers of a row side by side.
template <class Scalar>
bool has_rows_of(const py::array& array) {
  constexpr auto size = static_cast<py::ssize_t>(sizeof(Scalar));
  return py::isinstance<py::array_t<Scalar>>(array) && array.ndim() == 2 &&
         array.strides(1) == size && array.strides(0) > 0 && array.strides(0) % size == 0 &&
         reinterpret_cast<std::uintptr_t>(array.data()) % sizeof(Scalar) == 0;
}

py::array checked_numbers(const ArrayLike& values, const std::string& name) {
  const auto array = py::array::ensure(values.value);
  if (!array || std::string("fiu").find(array.dtype().kind()) == std::string::npos)
    return to_float64(values, name);  // which says what is wrong
  return array;
}

/// The rows of an image of points, (H, W, 3) or (H, W, 4), that are numbers: cameras write NaN
/// where they saw nothing. Whatever else as it is.
py::array without_image(const py::array& array, const std::string& name) {
  if (array.ndim() != 3 || (array.shape(2) != 3 && array.shape(2) != 4)) return array;
  const py::object rows = array.attr("reshape")(-1, array.shape(2));
  const py::object numpy = py::module_::import("numpy");
  const py::array kept =
      rows[numpy.attr("isfinite")(rows).attr("all")(py::arg("axis") = 1)].cast<py::array>();
  if (kept.shape(0) == 0 && array.size() > 0) {
    throw std::invalid_argument(name + " of shape " + shape_of(array) +
                                " has NaN or infinity in each pixel: a camera that saw nothing, "
                                "perhaps, which does not say that nothing is there");
  }
  return kept;
}

}  // namespace

PointsView::PointsView(const std::optional<ArrayLike>& points, const std::string& name) {
  if (!points) return;
  py::array array = without_image(checked_numbers(*points, name), name);
  if (!has_rows_of<float>(array) && !has_rows_of<double>(array))
    array = to_float64(ArrayLike{array}, name);
  take(array, name);
}

PointsView PointsView::float64(const std::optional<ArrayLike>& points, const std::string& name) {
  PointsView view;
  if (!points) return view;
  py::array array = without_image(checked_numbers(*points, name), name);
  if (!has_rows_of<double>(array)) array = to_float64(ArrayLike{array}, name);
  view.take(array, name);
  return view;
}

void PointsView::take(const py::array& array, const std::string& name) {
  array_ = array;
  if (array.ndim() >= 1 && array.shape(0) == 0) return;
  if (array.ndim() != 2) fail_shape(array, name, "(N, 3) or (N, 4), or (H, W, 3) of a camera");
  is_single_ = py::isinstance<py::array_t<float>>(array);
  const auto rows = array.shape(0), columns = array.shape(1);
  const auto stride = array.strides(0) / array.itemsize();
  if (is_single_) {
    new (&single_) Rows<float>(static_cast<const float*>(array.data()), rows, columns,
                               Eigen::OuterStride<>(stride));
  } else {
    new (&double_) Rows<double>(static_cast<const double*>(array.data()), rows, columns,
                                Eigen::OuterStride<>(stride));
  }
}

}  // namespace pdoik::python
