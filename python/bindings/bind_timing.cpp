#include "arrays.hpp"
#include "bind.hpp"
#include "pdoik/timing.hpp"

namespace pdoik::python {

void bind_timing(py::module_& module) {
  module.def(
      "fastest_squares",
      [](const Eigen::VectorXd& s, const RowMatrix& a, const RowMatrix& b,
         const Eigen::VectorXd& most) { return fastest_squares(s, a, b, most); },
      py::arg("s"), py::arg("a"), py::arg("b"), py::arg("most"),
      R"(The fastest way from rest to rest along a grid.

With x the square of ds/dt and u = x'/2, at both ends of each cell, on which u is constant,

    \|a u + b x\| <= 1,    0 <= x <= most

Args:
    s: Rising, shape (m,).
    a: One column a constraint, shape (m, k).
    b: The same.
    most: Positive, shape (m,).

Returns:
    x, shape (m,), 0 at both ends.

Raises:
    ValueError: Shapes do not belong together, or s does not rise.)");
}

}  // namespace pdoik::python
