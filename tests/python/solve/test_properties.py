"""Whatever comes in, out comes an exception of the right kind or a result whose claims hold."""

import os
import subprocess
import sys
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import pdoik
from conftest import ROBOTS, SHIPPED
from references import PinocchioRobot
from samples import random_configuration
from test_solver import confirm

PANDA_XML = (ROBOTS / "panda.urdf").read_text()
TOKENS = [
    "<",
    ">",
    "/>",
    '"',
    "nan",
    "inf",
    "1e999",
    "-",
    "0",
    "",
    "panda_link1",
    "fixed",
    "\0",
    "é",
]


def load_or_refuse(text: str | bytes, loader: object) -> object:
    """What loads; None for what is refused as it should be."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pdoik.RobotWarning)
        try:
            return loader(text)
        except pdoik.LoadError as error:
            assert str(error)  # noqa: PT017
            return None


def check_moves(robot: pdoik.Robot | None) -> None:
    """A robot that loaded has finite kinematics."""
    if robot is None:
        return
    q = np.clip(np.full(robot.dof, 0.1), robot.lower, robot.upper)
    assert (robot.lower <= robot.upper).all()
    for link in robot.link_names:
        T = robot.fk(q, link)
        assert np.isfinite(T).all()
        np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-9)


@given(text=st.text())
def test_garbage_is_a_load_error(text: str) -> None:
    assert load_or_refuse(text, pdoik.Robot.from_urdf) is None
    assert load_or_refuse("<" + text, pdoik.Robot.from_urdf) is None
    for each in (text, text + "\n", "spheres: " + text):
        load_or_refuse(each, pdoik.Occupancy.load)


@given(cut=st.integers(0, len(PANDA_XML.rstrip()) - 1))
def test_half_a_urdf_is_a_load_error(cut: int) -> None:
    assert load_or_refuse(PANDA_XML[:cut], pdoik.Robot.from_urdf) is None


@given(
    edits=st.lists(
        st.tuples(st.integers(0, len(PANDA_XML)), st.integers(0, 12), st.sampled_from(TOKENS)),
        min_size=1,
        max_size=6,
    )
)
@settings(max_examples=400)
def test_a_spoilt_urdf_is_refused_or_moves(edits: list[tuple[int, int, str]]) -> None:
    text = PANDA_XML
    for start, length, token in edits:
        text = text[:start] + token + text[start + length :]
    check_moves(load_or_refuse(text, pdoik.Robot.from_urdf))


@given(
    edits=st.lists(st.tuples(st.integers(0, len(PANDA_XML) - 1), st.integers(0, 255)), max_size=8)
)
@settings(max_examples=300)
def test_a_file_with_odd_bytes_is_refused_or_moves(
    tmp_path_factory: pytest.TempPathFactory, edits: list[tuple[int, int]]
) -> None:
    data = bytearray(PANDA_XML.encode())
    for place, value in edits:
        data[place] = value
    path = tmp_path_factory.getbasetemp() / "odd.urdf"
    path.write_bytes(data)
    check_moves(load_or_refuse(path, pdoik.Robot.from_urdf))


@given(name=st.text(min_size=1), numbers=st.lists(st.floats(0.001, 1e3), min_size=8, max_size=8))
def test_an_occupancy_survives_its_text(name: str, numbers: list[float]) -> None:
    x, y, z, r, *more = numbers
    hulls = pdoik.Occupancy(
        spheres=[(name, (x, -y, z), r)],
        spheroids=[("a", tuple(more[:3]), name, (-x, y, z), more[3])],
    )
    assert pdoik.Occupancy.load(hulls.to_yaml()) == hulls


# In another process, because what these once did is end it.
@pytest.mark.parametrize(
    "code",
    [
        "pdoik.Robot.from_urdf('<robot name=\"r\">' + 60_000 * '<link>')",
        "pdoik.Robot.from_urdf(60_000 * '<a>' + 60_000 * '</a>')",
        "pdoik.Robot.from_urdf(chain(100_000))",
        "pdoik.Occupancy.load('spheres: ' + 60_000 * '[')",
        "pdoik.Occupancy.load('? [a]\\n: b')",
        "pdoik.Occupancy.load('/')",
    ],
    ids=["open tags", "nested tags", "long chain", "nested lists", "odd key", "folder"],
)
def test_input_that_could_end_the_process_is_a_load_error(code: str) -> None:
    script = f"""
import pdoik
def chain(n):
    links = "".join(f'<link name="l{{i}}"/>' for i in range(n + 1))
    joints = "".join(
        f'<joint name="j{{i}}" type="continuous">'
        f'<parent link="l{{i}}"/><child link="l{{i + 1}}"/></joint>'
        for i in range(n)
    )
    return f'<robot name="r">{{links}}{{joints}}</robot>'
try:
    {code}
except pdoik.LoadError as error:
    print("refused")
"""
    run = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )
    assert (run.returncode, run.stdout) == (0, "refused\n"), run.stderr


def test_a_batch_for_which_there_are_no_threads_runs_on_the_one_there_is() -> None:
    # A thread's stack of 4 GiB does not fit into the 3 GiB that the process may have.
    script = """
import resource
import numpy as np, pdoik
robot = pdoik.Robot.builtin("panda")
solver = pdoik.Solver(robot)
T = np.stack(4 * [robot.fk(robot.mid_configuration())])
resource.setrlimit(resource.RLIMIT_AS, (3 << 30, 3 << 30))
print(solver.solve_batch(T, threads=4).success.all())
"""
    run = subprocess.run(
        ["bash", "-c", 'ulimit -s 4194304 && exec "$@"', "-", sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
    )
    assert (run.returncode, run.stdout) == (0, "True\n"), run.stderr


SOLVERS = {
    name: pdoik.Solver(pdoik.Robot.builtin(name), pdoik.Options(max_time=0.02, max_restarts=2))
    for name in SHIPPED
}
REFERENCES = {
    name: PinocchioRobot.from_xml((ROBOTS / f"{name}.urdf").read_text()) for name in SHIPPED
}
ANY_FLOAT = st.floats(width=64)
SHAPES = arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=5)


@given(
    target=arrays.arrays(
        np.float64, st.sampled_from([(4, 4), (3, 4), (16,), (2, 4, 4)]), elements=ANY_FLOAT
    ),
    cloud=arrays.arrays(np.float64, SHAPES, elements=ANY_FLOAT),
    q0=arrays.arrays(np.float64, st.integers(0, 9), elements=ANY_FLOAT),
)
@settings(max_examples=300)
def test_any_arrays_are_refused_or_answered(
    target: np.ndarray, cloud: np.ndarray, q0: np.ndarray
) -> None:
    solver = SOLVERS["panda"]
    T = solver.robot.fk(solver.robot.mid_configuration())
    for call in (
        lambda: solver.solve(target, q0=q0, obstacles=cloud),
        lambda: solver.solve(T, q0=q0),
        lambda: solver.solve(T, obstacles=cloud),
        lambda: solver.solve_batch(np.stack([T, T]), q0=q0, obstacles=cloud),
        lambda: solver.solve_batch(target),
    ):
        try:
            result = call()
        except ValueError as error:
            assert any(name in str(error) for name in ("T_base_tip", "q0", "obstacles"))  # noqa: PT017
        else:
            assert np.isfinite(result.q).all()


@given(
    name=st.sampled_from(SHIPPED),
    seed=st.integers(0, 2**32),
    position=arrays.arrays(np.float64, 3, elements=st.floats(-1.5, 1.5)),
    cloud=arrays.arrays(
        np.float64,
        st.tuples(st.integers(0, 12), st.just(4)),
        elements=st.floats(-1.5, 1.5).map(lambda x: round(x, 3)),
    ),
)
@settings(max_examples=200)
def test_answers_to_any_pose_and_cloud_are_true(
    name: str, seed: int, position: np.ndarray, cloud: np.ndarray
) -> None:
    solver, reference = SOLVERS[name], REFERENCES[name]
    rng = np.random.default_rng(seed)
    target = solver.robot.fk(random_configuration(solver.robot, rng))
    if seed % 2:
        target[:3, 3] = position
    cloud[:, 3] = 0.1 * np.abs(cloud[:, 3])
    confirm(solver.solve(target, obstacles=cloud), solver, reference, target, cloud)


@given(
    point=arrays.arrays(np.float64, 3, elements=st.floats(-1e300, 1e300)),
    scale=st.sampled_from([1.0, 1e6, 1e18, 1e20, 1e31, 1e155, 1e300]),
)
@settings(max_examples=200)
def test_a_ball_that_swallows_the_robot_is_never_clear_of_it(
    point: np.ndarray, scale: float
) -> None:
    length = np.abs(point).max()
    centre = scale * (point / length) if length > 0 else point
    solver = SOLVERS["panda"]
    T = solver.robot.fk(solver.robot.mid_configuration())
    ball = np.array([[*centre, 3.0 * scale]])
    try:
        result = solver.solve(T, obstacles=ball)
    except ValueError as error:
        assert "obstacles" in str(error)  # noqa: PT017
    else:
        assert not result.success
        assert result.clearance < 0
