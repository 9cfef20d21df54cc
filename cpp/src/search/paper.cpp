#include "search/paper.hpp"

#include "search/outcome.hpp"

namespace pdoik::detail {

void solve_as_in_the_paper(Workspace& workspace, const Request& request, Result& result) {
  const Model& model = workspace.model();
  const Scene& scene = workspace.scene();
  const Deadline deadline = workspace.deadline_in(model.options.max_time);
  workspace.watch(deadline);
  workspace.problem.set_goals(request.goals);
  begin_result(result);
  Eigen::VectorXd &omega = workspace.omega, &start = workspace.start, &q = workspace.q;
  if (request.q0 != nullptr) {
    workspace.map.inverse(*request.q0, omega, model.options.start_inset);
    start = *request.q0;
  } else {
    omega.setZero();  // Algorithm IK, line 1
    workspace.map.positions(omega, start);
  }
  workspace.minimise_lagrangian(result);
  workspace.map.positions(omega, q);  // Eq. recovery
  model.wrap(start, q);
  workspace.judge(request.goals, q, result);
  end_result(why_hopeless(model, request.goals, scene.base_collides()), deadline, scene.intake,
             result);
  name_base_contact(scene, model.options, result);
}

}  // namespace pdoik::detail
