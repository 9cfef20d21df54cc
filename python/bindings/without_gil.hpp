#pragma once

#include <pybind11/pybind11.h>

#include <optional>

namespace pdoik::python {

namespace py = pybind11;

/// Lets other Python threads run while this one computes, and the interpreter end in good order:
/// before it takes anything down it waits for those who compute, and none begins any more. A thread
/// that came back later would be ended in the middle of C++, which aborts the process.
class WithoutGil {
 public:
  WithoutGil();
  ~WithoutGil();
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

 private:
  std::optional<py::gil_scoped_release> release_;
};

/// Whether what is being computed is to end: Python's signal handlers run here, and one has raised,
/// which is then the thread's exception; or the interpreter ends. To be asked without the GIL.
bool is_interrupted();
/// Throws what a handler has raised.
void raise_if_interrupted();

/// Let the end of the interpreter wait for who computes.
void bind_end(py::module_& module);

}  // namespace pdoik::python
