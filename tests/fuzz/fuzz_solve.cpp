#include <cstdint>
#include <stdexcept>

#include "decode.hpp"
#include "judgement.hpp"
#include "pdoik/errors.hpp"

/// Solves from bytes: misuse is refused by invalid_argument or LoadError, any answer holds the
/// limits, and a success is one.
namespace pdoik::fuzz {
namespace {

struct Asked {
  std::vector<Goal> goals;
  std::optional<Eigen::VectorXd> q0, posture, max_step;
};

Asked ask(Bytes& bytes, const Robot& robot, const Options& options) {
  Asked asked;
  asked.goals = goals(bytes, robot, options);
  if (bytes.one_in(2)) asked.q0 = configuration(bytes, robot);
  if (bytes.one_in(4)) asked.posture = configuration(bytes, robot);
  if (bytes.one_in(6)) asked.max_step = vector(bytes, robot.dof(), 0.0, 0.5);
  return asked;
}

void check_result(const Solver& solver, const Asked& asked, const Cloud& obstacles,
                  const Result& result) {
  const Robot& robot = solver.robot();
  check_configuration(robot, result.q);
  PDOIK_PROPERTY(result.success == (result.status == Status::Solved), to_string(result.status));
  PDOIK_PROPERTY(!solver.describe(result.worst).empty() || result.success);
  if (result.success) check_success(robot, solver.options(), asked.goals, obstacles, result);
  if (!asked.q0) return;
  const Eigen::VectorXd start = asked.q0->cwiseMax(robot.lower()).cwiseMin(robot.upper());
  for (Eigen::Index i = 0; i < robot.dof(); ++i) {
    const double moved = std::abs(result.q[i] - start[i]);
    const double rounding = 1e-12 * std::max(1.0, std::abs(start[i]));
    if (asked.max_step)
      PDOIK_PROPERTY(moved <= (*asked.max_step)[i] + rounding, "joint " << i << ": " << moved);
    if (robot.joint_types()[static_cast<std::size_t>(i)] == JointType::Continuous &&
        std::isinf(robot.upper()[i]))
      PDOIK_PROPERTY(moved <= M_PI + rounding, "joint " << i << ": " << moved);
  }
}

/// Some solves by one solver, so that none leaves anything behind that harms the next.
void solve_some(Bytes& bytes) {
  const Robot made = robot(bytes);
  Solver solver(made, options(bytes, made));
  Cloud obstacles(0, 3);
  Result result;
  for (int k = bytes.integer(1, 3); k > 0; --k) {
    try {
      if (bytes.one_in(4)) solver.clear_obstacles(), obstacles.resize(0, 3);
      if (!bytes.one_in(4)) {
        const Cloud next = cloud(bytes, made);
        solver.set_obstacles(next);
        obstacles = next;
      }
      const Asked asked = ask(bytes, made, solver.options());
      const auto given = [](const std::optional<Eigen::VectorXd>& v) { return v ? &*v : nullptr; };
      solver.solve({.goals = asked.goals,
                    .q0 = given(asked.q0),
                    .posture = given(asked.posture),
                    .max_step = given(asked.max_step)},
                   result);
      check_result(solver, asked, obstacles, result);
      const Eigen::VectorXd any = configuration(bytes, made);
      Result judged;
      solver.judge(asked.goals, any, judged);
      if (judged.success) check_success(made, solver.options(), asked.goals, obstacles, judged);
    } catch (const std::invalid_argument& refused) {  // and the solver is still good
      PDOIK_PROPERTY(*refused.what() != 0);
    }
  }
}

}  // namespace
}  // namespace pdoik::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pdoik::fuzz::Bytes bytes(data, size);
  try {
    pdoik::fuzz::solve_some(bytes);
  } catch (const std::invalid_argument&) {
  } catch (const pdoik::LoadError&) {
  }
  return 0;
}
