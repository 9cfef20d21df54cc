#include "without_gil.hpp"

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace pdoik::python {
namespace {

std::atomic<int> computing{0};         // threads, which change it with the GIL held
std::atomic<bool> is_ending{false};    // from when on none begins
std::atomic<bool> has_ended{false};    // from when on none may come back
std::atomic<std::thread::id> ends_it;  // the thread that ends the interpreter, which may go on

bool must_stop() { return is_ending && std::this_thread::get_id() != ends_it.load(); }

[[noreturn]] void wait_for_the_end() {
  while (true) std::this_thread::sleep_for(std::chrono::hours(1));
}

/// All of them look ten times a second whether they are to end, but for who takes in a cloud.
constexpr std::chrono::seconds kLongest{20};

void end() {
  ends_it = std::this_thread::get_id();
  is_ending = true;
  const py::gil_scoped_release release;
  const auto latest = std::chrono::steady_clock::now() + kLongest;
  while (computing > 0 && std::chrono::steady_clock::now() < latest)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  has_ended = true;
}

}  // namespace

WithoutGil::WithoutGil() {
  if (must_stop()) {
    const py::gil_scoped_release release;
    wait_for_the_end();
  }
  ++computing;
  release_.emplace();
}

WithoutGil::~WithoutGil() {
  if (has_ended && must_stop()) wait_for_the_end();
  release_.reset();
  --computing;
}

bool is_interrupted() {
  if (must_stop()) return true;
  const py::gil_scoped_acquire acquire;
  return PyErr_CheckSignals() != 0;
}

void raise_if_interrupted() {
  const py::gil_scoped_acquire acquire;
  if (PyErr_Occurred() != nullptr || PyErr_CheckSignals() != 0) throw py::error_already_set();
}

void bind_end(py::module_&) {
  // A child process has none of the threads that compute in its parent.
  pthread_atfork(nullptr, nullptr, [] { computing = 0; });
  py::module_::import("atexit").attr("register")(py::cpp_function(&end));
}

}  // namespace pdoik::python
