"""The paper's objective in other people's optimisers."""

import numpy as np
import pytest
from scipy.optimize import check_grad, minimize

import pdoik

VARIABLES = ("slack", "positions")


def cluttered(robot: pdoik.Robot, variables: str, rng: np.random.Generator) -> pdoik.Lagrangian:
    """An objective whose constraints act at most configurations."""
    options = pdoik.Options(
        goal="axis", augmented_lagrangian=pdoik.AugmentedLagrangianOptions(form="smooth")
    )
    objective = pdoik.Lagrangian(robot, options, variables)
    objective.set_target(robot.fk(rng.uniform(robot.lower, robot.upper)))
    objective.set_obstacles(rng.uniform([-0.5, -0.5, 0.1, 0.0], [0.5, 0.5, 0.9, 0.1], (40, 4)))
    return objective


@pytest.mark.parametrize("variables", VARIABLES)
def test_gradient_is_that_of_the_value(
    robot: pdoik.Robot, variables: str, rng: np.random.Generator
) -> None:
    objective = cluttered(robot, variables, rng)
    touched = 0
    for _ in range(10):
        x = objective.variables(rng.uniform(robot.lower, robot.upper))
        objective.update_multipliers(x, 5.0)
        gradient = objective(x, 5.0)[1]
        error = check_grad(lambda x: objective(x, 5.0)[0], lambda x: objective(x, 5.0)[1], x)
        assert error < 1e-5 * (1 + np.linalg.norm(gradient))
        touched += objective.last_max_constraint > 0
    assert touched > 2


@pytest.mark.parametrize("variables", VARIABLES)
def test_scipy_reaches_targets_with_it(
    robot: pdoik.Robot, variables: str, rng: np.random.Generator
) -> None:
    objective = pdoik.Lagrangian(robot, variables=variables)
    limits = list(zip(robot.lower, robot.upper, strict=True))
    reached = 0
    for _ in range(20):
        T_base_tip = robot.fk(rng.uniform(robot.lower, robot.upper))
        objective.set_target(T_base_tip)
        found = minimize(
            objective,
            objective.variables(robot.mid_configuration()),
            args=(1.0,),
            jac=True,
            method="L-BFGS-B",
            bounds=limits if variables == "positions" else None,
            options={"maxiter": 400, "ftol": 0, "gtol": 1e-10},
        )
        q = objective.positions(found.x)
        assert (q >= robot.lower).all()
        assert (q <= robot.upper).all()
        reached += np.abs(robot.fk(q) - T_base_tip).max() < 1e-3
    assert reached >= 10


def test_variables_and_positions_are_inverse_to_each_other(
    robot: pdoik.Robot, rng: np.random.Generator
) -> None:
    q = robot.mid_configuration() + rng.uniform(-0.3, 0.3, robot.dof) * (robot.upper - robot.lower)
    for variables in VARIABLES:
        objective = pdoik.Lagrangian(robot, variables=variables)
        assert objective.size == robot.dof
        np.testing.assert_allclose(objective.positions(objective.variables(q)), q, atol=1e-9)


def test_multipliers_raise_the_value_until_they_are_reset(rng: np.random.Generator) -> None:
    robot = pdoik.Robot.builtin("panda")
    objective = cluttered(robot, "positions", rng)
    q = robot.mid_configuration()
    objective.set_obstacles([[*robot.fk(q)[:3, 3], 0.1]])  # in the hand's way
    before = objective(q, 1.0)[0]
    assert objective.max_constraint(q) > 0
    objective.update_multipliers(q, 1.0)
    assert objective(q, 1.0)[0] > before
    objective.reset_multipliers()
    assert objective(q, 1.0)[0] == before
    objective.set_obstacles(None)
    assert objective.max_constraint(q) == 0


def test_misuse_is_refused() -> None:
    robot = pdoik.Robot.builtin("panda")
    with pytest.raises(ValueError, match=r"variables is 'angles', expected one of 'slack'"):
        pdoik.Lagrangian(robot, variables="angles")  # type: ignore[arg-type]
    objective = pdoik.Lagrangian(robot)
    with pytest.raises(ValueError, match="not a rigid transform"):
        objective.set_target(np.diag([1.1, 1, 1, 1]))
    with pytest.raises(ValueError, match="negative radius"):
        objective.set_obstacles([[0, 0, 0, -1]])
    with pytest.raises(ValueError, match="x"):
        objective(np.zeros(3), 1.0)
    with pytest.raises(ValueError, match="rho"):
        objective(np.zeros(7), 0.0)
    with pytest.raises(ValueError, match="rho"):
        objective.update_multipliers(np.zeros(7), np.nan)
    with pytest.raises(ValueError, match="q has shape"):
        objective.variables([0, 0, 0])
