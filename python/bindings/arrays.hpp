#pragma once

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "pdoik/cloud.hpp"
#include "pdoik/solver.hpp"

namespace pdoik::python {

namespace py = pybind11;

/// Whatever NumPy makes an array of. The functions below turn it into numbers, or raise TypeError
/// or ValueError with the argument's name, what was expected and what came.
struct ArrayLike {
  py::object value;
};

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
using Matrix3X = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
using Matrix6X = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;

/// Float64 and row-major; the array itself if it is that already.
Array to_float64(const ArrayLike& values, const std::string& name);

Eigen::VectorXd to_vector(const ArrayLike& values, const std::string& name, Eigen::Index size);
Eigen::Vector3d to_vector3(const ArrayLike& values, const std::string& name);
Eigen::Isometry3d to_isometry(const ArrayLike& values, const std::string& name);
std::vector<Eigen::Isometry3d> to_isometries(const ArrayLike& values, const std::string& name);
/// One start of shape (n,) or several of shape (B, n).
std::vector<Eigen::VectorXd> to_vectors(const ArrayLike& values, const std::string& name,
                                        Eigen::Index size);

/// A NumPy array of str.
struct StrArray : py::array {
  using py::array::array;
};

/// Points that C++ reads where Python keeps them, if they are float64 or float32 in rows without
/// gaps within. Made and destroyed with the GIL held.
class PointsView {
 public:
  /// None and arrays with no rows hold no points. NaN is left to who reads them.
  PointsView(const std::optional<ArrayLike>& points, const std::string& name);
  bool is_single() const { return is_single_; }
  Obstacles in_double() const { return Obstacles(double_); }
  ObstaclesF in_single() const { return ObstaclesF(single_); }
  operator Obstacles() const { return in_double(); }  ///< of points that are not single

  /// Points as float64, whatever they came as.
  static PointsView float64(const std::optional<ArrayLike>& points, const std::string& name);

 private:
  PointsView() = default;
  void take(const py::array& array, const std::string& name);

  template <class Scalar>
  using Rows =
      Eigen::Map<const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 0,
                 Eigen::OuterStride<>>;
  py::array array_;
  bool is_single_ = false;
  Rows<double> double_{nullptr, 0, 3, Eigen::OuterStride<>(3)};
  Rows<float> single_{nullptr, 0, 3, Eigen::OuterStride<>(3)};
};

/// Obstacles of a solve: an array of points, a Cloud, shapes, or a Scene of both.
struct ObstaclesLike {
  py::object value;
};

}  // namespace pdoik::python

template <>
struct pybind11::detail::type_caster<pdoik::python::ArrayLike> {
  PYBIND11_TYPE_CASTER(pdoik::python::ArrayLike, const_name("numpy.typing.ArrayLike"));
  bool load(handle source, bool) {
    if (!source || source.is_none()) return false;
    value.value = reinterpret_borrow<object>(source);
    return true;
  }
};

template <>
struct pybind11::detail::type_caster<pdoik::python::ObstaclesLike> {
  PYBIND11_TYPE_CASTER(
      pdoik::python::ObstaclesLike,
      const_name("numpy.typing.ArrayLike | pdoik._core.Cloud | pdoik._core.Scene | "
                 "collections.abc.Sequence[pdoik._core.Shape]"));
  bool load(handle source, bool) {
    if (!source || source.is_none()) return false;
    value.value = reinterpret_borrow<object>(source);
    return true;
  }
};

template <>
struct pybind11::detail::handle_type_name<pdoik::python::StrArray> {
  static constexpr auto name = const_name("numpy.typing.NDArray[numpy.str_]");
};
