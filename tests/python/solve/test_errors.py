"""Misuse is refused at the border, by name, with what was expected and what came."""

import dataclasses
import pickle
from typing import get_args, get_type_hints

import numpy as np
import pytest

import pdoik
from pdoik import _core
from pdoik._option_values import to_core

T = pdoik.Robot.builtin("panda").fk(np.zeros(7))
NESTED = {
    "touch": pdoik.Touch,
    "balance": pdoik.Balance,
    "lbfgs": pdoik.LbfgsOptions,
    "augmented_lagrangian": pdoik.AugmentedLagrangianOptions,
    "levenberg_marquardt": pdoik.LevenbergMarquardtOptions,
}


@pytest.fixture(scope="module")
def panda() -> pdoik.Robot:
    return pdoik.Robot.builtin("panda")


@pytest.fixture(scope="module")
def solver(panda: pdoik.Robot) -> pdoik.Solver:
    return pdoik.Solver(panda)


def rigid(**changes: float) -> np.ndarray:
    pose = T.copy()
    for place, value in changes.items():
        pose[int(place[1]), int(place[2])] = value
    return pose


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"T_base_tip": T[:3]}, r"T_base_tip has shape \(3, 4\), expected \(4, 4\)"),
        ({"T_base_tip": T[None]}, r"T_base_tip has shape \(1, 4, 4\), expected \(4, 4\)"),
        ({"T_base_tip": 1.0}, r"T_base_tip has shape \(\), expected \(4, 4\)"),
        ({"T_base_tip": rigid(r03=np.nan)}, "T_base_tip holds NaN or infinity"),
        ({"T_base_tip": rigid(r33=np.inf)}, "T_base_tip holds NaN or infinity"),
        ({"T_base_tip": rigid(r30=1.0)}, "T_base_tip has a last row"),
        ({"T_base_tip": rigid(r00=3.0)}, "T_base_tip is not a rigid"),
        ({"T_base_tip": T @ np.diag([1, 1, -1, 1])}, "T_base_tip is not a rigid"),
        ({"T_base_tip": T @ np.diag([2, 2, 2, 1])}, "T_base_tip is not a rigid"),
        ({"T_base_tip": [[1, 2], [3]]}, "T_base_tip is not an array of numbers"),
        ({"q0": np.zeros(6)}, r"q0 has shape \(6,\), expected \(7,\)"),
        ({"q0": np.zeros((1, 7))}, r"q0 has shape \(1, 7\), expected \(7,\)"),
        ({"q0": np.full(7, np.nan)}, "q0 holds NaN or infinity"),
        ({"obstacles": np.zeros(3)}, r"obstacles has shape \(3,\), expected \(N, 3\) or \(N, 4\)"),
        ({"obstacles": np.zeros((2, 2))}, r"obstacles has shape \(2, 2\), expected \(N, 3\)"),
        ({"obstacles": np.zeros((2, 5))}, r"obstacles has shape \(2, 5\), expected \(N, 3\)"),
        ({"obstacles": [[0, 0, 0], [0, np.nan, 0]]}, "obstacles holds NaN or infinity in row 1"),
        ({"obstacles": [[0, 0, 0, 1], [0, 0, 0, -1]]}, "obstacles has a negative radius in row 1"),
    ],
)
def test_a_bad_argument_to_solve_is_named(
    solver: pdoik.Solver, arguments: dict, message: str
) -> None:
    for call in (solver.solve, lambda **a: solver.judge(**{"q": np.zeros(7), **a})):
        if "q0" in arguments and call != solver.solve:
            continue
        with pytest.raises(ValueError, match=message):
            call(**{"T_base_tip": T, **arguments})


@pytest.mark.parametrize("value", ["abc", ["a"] * 7, [None] * 7, [1j] * 7, object(), b"x"])
def test_what_is_no_number_is_a_type_error_that_names_it(
    panda: pdoik.Robot, solver: pdoik.Solver, value: object
) -> None:
    for name, call in (
        ("q", panda.fk),
        ("q", panda.jacobian),
        ("q0", lambda q: solver.solve(T, q0=q)),
        ("obstacles", lambda x: solver.solve(T, obstacles=x)),
        ("T_base_tip", solver.solve),
        ("T_base_tip", solver.solve_batch),
        ("points", lambda x: pdoik.voxel_downsample(x, 0.1)),
    ):
        with pytest.raises(TypeError, match=f"{name} has dtype"):
            call(value)


@pytest.mark.parametrize("call", ["fk", "jacobian"])
def test_a_bad_configuration_is_named(panda: pdoik.Robot, call: str) -> None:
    for q, message in [
        (np.zeros(8), r"q has shape \(8,\), expected \(7,\)"),
        (np.zeros((7, 1)), r"q has shape \(7, 1\), expected \(7,\)"),
        ([0, 0, 0, 0, 0, 0, np.inf], "q holds NaN or infinity"),
        ([], r"q has shape \(0,\), expected \(7,\)"),
    ]:
        with pytest.raises(ValueError, match=message):
            getattr(panda, call)(q)


def test_judging_names_q_as_q(solver: pdoik.Solver) -> None:
    with pytest.raises(ValueError, match=r"^q has shape \(3,\), expected \(7,\)"):
        solver.judge(T, np.zeros(3))
    with pytest.raises(ValueError, match=r"^q holds NaN"):
        solver.judge(T, np.full(7, np.nan))


def test_load_errors_may_be_caught_three_ways() -> None:
    for kind in (pdoik.LoadError, pdoik.PdoikError, ValueError):
        with pytest.raises(kind, match="no-such-file"):
            pdoik.Robot.from_urdf("no-such-file.urdf")
        with pytest.raises(kind, match="no-such-file"):
            pdoik.Occupancy.load("no-such-file.yaml")


def test_unknown_options_are_named() -> None:
    for kind in (pdoik.Options, *NESTED.values()):
        with pytest.raises(TypeError, match="'max_tiem'"):
            kind(max_tiem=1)
        with pytest.raises(TypeError, match="positional"):
            kind(1)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"max_restarts": 1.5}, "Options.max_restarts is 1.5, expected int"),
        ({"max_time": "1"}, "Options.max_time is '1', expected float"),
        ({"max_time": None}, "Options.max_time is None, expected float"),
        ({"seed": -1}, "Options.seed is -1, expected int"),
        ({"goal": 3}, "Options.goal is 3, expected"),
        ({"lbfgs": 3}, "Options.lbfgs is 3, expected LbfgsOptions"),
        ({"lbfgs": {"memory": 3}}, "expected LbfgsOptions"),
        ({"lbfgs": pdoik.LevenbergMarquardtOptions()}, "expected LbfgsOptions"),
    ],
)
def test_options_of_the_wrong_type_are_named(arguments: dict, message: str) -> None:
    with pytest.raises(TypeError, match=message):
        pdoik.Options(**arguments)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"goal": "poses"}, "goal is 'poses', expected one of 'pose', 'axis', 'position'"),
        ({"method": "best"}, "method is 'best', expected one of 'default', 'paper'"),
        ({"inner": "newton"}, "inner is 'newton', expected one of"),
        ({"goal_axis": "w"}, "goal_axis is 'w', expected 'x', 'y', 'z' or"),
        ({"goal_axis": [1, 0]}, r"goal_axis has shape \(2,\), expected \(3,\)"),
    ],
)
def test_choices_that_do_not_exist_are_named(arguments: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        pdoik.Options(**arguments)
    with pytest.raises(ValueError, match="form is 'odd', expected one of 'printed', 'smooth'"):
        pdoik.Options(augmented_lagrangian=pdoik.AugmentedLagrangianOptions(form="odd"))


@pytest.mark.parametrize(
    "arguments",
    [
        *({name: value} for value in (0.0, -1.0, np.nan) for name in (
            "max_time", "position_tolerance", "rotation_tolerance", "collision_weight",
            "start_inset",
        )),
        *({name: value} for value in (-1.0, np.nan) for name in (
            "rotation_weight", "point_distance",
        )),
        *({"clearance": value} for value in (np.nan, np.inf)),
        *({"clearance_tolerance": value} for value in (np.nan, np.inf, -1)),
        *({name: -1} for name in ("max_restarts", "max_obstacles")),
        {"start_inset": 0.5},
        *({"goal_axis": (x, 0.0, 0.0)} for x in (0.0, np.nan, np.inf)),
    ],
    ids=str,
)  # fmt: skip
def test_numbers_out_of_range_are_named(panda: pdoik.Robot, arguments: dict) -> None:
    with pytest.raises(ValueError, match=f"{next(iter(arguments))} is"):
        pdoik.Solver(panda, pdoik.Options(**arguments))


@pytest.mark.parametrize(
    ("part", "name", "value"),
    [
        *(("lbfgs", name, 0) for name in ("memory", "first_step", "max_step", "armijo")),
        *(("lbfgs", name, -1) for name in ("max_iterations", "max_line_search")),
        ("lbfgs", "curvature", 1.0),
        ("augmented_lagrangian", "rho", 0.0),
        ("augmented_lagrangian", "rho_growth", np.nan),
        ("augmented_lagrangian", "max_outer_iterations", -1),
        ("levenberg_marquardt", "max_iterations", -1),
        ("levenberg_marquardt", "first_damping", np.nan),
        ("levenberg_marquardt", "damping_increase", 1.0),
        ("levenberg_marquardt", "damping_decrease", 0.0),
        ("levenberg_marquardt", "stall_window", 0),
    ],
)
def test_nested_numbers_out_of_range_are_named(
    panda: pdoik.Robot, part: str, name: str, value: float
) -> None:
    with pytest.raises(ValueError, match=name):
        pdoik.Solver(panda, pdoik.Options(**{part: NESTED[part](**{name: value})}))


def properties_of(kind: type) -> set[str]:
    return {name for name, value in vars(kind).items() if isinstance(value, property)}


def test_every_option_of_the_core_is_an_option_here_with_the_same_default() -> None:
    def compare(ours: object, core: object) -> None:
        fields = {field.name for field in dataclasses.fields(ours)}
        assert fields == properties_of(type(core))
        for name in fields - {"goal_axis"}:
            mine, its = getattr(ours, name), getattr(core, name)
            if name in NESTED:
                compare(mine, its)
            elif isinstance(mine, tuple):
                np.testing.assert_array_equal(mine, its)
            else:
                assert mine == its

    compare(pdoik.Options(), _core.Options())
    np.testing.assert_array_equal(to_core(pdoik.Options()).goal_axis, [0, 0, 1])


def test_every_option_reaches_the_core() -> None:
    def changed(kind: type) -> dict:
        hints, result = get_type_hints(kind), {}
        for field in dataclasses.fields(kind):
            if field.name in NESTED:
                result[field.name] = NESTED[field.name](**changed(NESTED[field.name]))
            elif field.name == "contacts":
                result[field.name] = {"sole": [(0.1, 0.2, 0.3)]}
            elif field.name == "links":
                result[field.name] = ("sole", "heel")
            elif field.name == "T_tip_tool":
                result[field.name] = np.diag([-1.0, -1.0, 1.0, 1.0])
            elif field.name == "goal_axis" or isinstance(field.default, tuple):
                result[field.name] = (0.1, 0.2, 0.3)
            elif isinstance(field.default, str):
                choices = get_args(hints[field.name])
                result[field.name] = next(c for c in choices if c != field.default)
            elif field.name == "self_collision":
                result[field.name] = True
            elif isinstance(field.default, bool):
                result[field.name] = not field.default
            else:
                result[field.name] = 3 if field.default != 3 else 4
        return result

    def compare(values: dict, core: object) -> None:
        for name, value in values.items():
            if name in NESTED:
                compare(dataclasses.asdict(value), getattr(core, name))
            elif name == "contacts":
                its = getattr(core, name)
                assert its.keys() == value.keys()
                np.testing.assert_array_equal(its["sole"], value["sole"])
            else:
                np.testing.assert_array_equal(getattr(core, name), value)

    values = changed(pdoik.Options)
    compare(values, to_core(pdoik.Options(**values)))


def test_options_are_values() -> None:
    options = pdoik.Options(goal="axis", goal_axis=np.array([1.0, 0.0, 0.0]), max_time=1)
    assert (
        options
        == pickle.loads(pickle.dumps(options))
        == pdoik.Options(goal="axis", goal_axis=(1, 0, 0), max_time=1)
    )
    assert len({options, dataclasses.replace(options), pdoik.Options()}) == 2
    assert eval(repr(options), {**vars(pdoik), "inf": np.inf}) == options
    with pytest.raises(dataclasses.FrozenInstanceError):
        options.max_time = 2.0


def test_the_version_is_the_package_s() -> None:
    assert pdoik.__version__.count(".") == 2
    assert sorted(pdoik.__all__) == pdoik.__all__
    assert all(hasattr(pdoik, name) for name in pdoik.__all__)
