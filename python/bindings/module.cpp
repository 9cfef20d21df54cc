#include "bind.hpp"
#include "pdoik/simd.hpp"
#include "without_gil.hpp"

PYBIND11_MODULE(_core, module) {
  using namespace pdoik::python;
  module.doc() = "The compiled half of pdoik. Its names are to be had from `pdoik` itself.";
  bind_end(module);
  bind_errors(module);
  bind_occupancy(module);
  bind_cloud(module);
  bind_shape(module);
  bind_contacts(module);
  bind_scene(module);
  bind_robot(module);
  bind_options(module);
  bind_goal(module);
  bind_result(module);
  bind_solver(module);
  bind_tracker(module);
  bind_timing(module);
  bind_lagrangian(module);
  bind_point_cloud(module);
  bind_shrink_wrap(module);
  module.def("simd_name", &pdoik::simd_name,
             R"(The instructions that this process's kernels use: "avx512", "avx2" or "baseline".

The best that the processor has, or what the environment variable PDOIK_SIMD names if that is less.)");
}
