"""The worlds' physics by another library, their files, and that nothing gives the answer away."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco")
pin = pytest.importorskip("pinocchio")
signal = pytest.importorskip("scipy.signal")
yaml = pytest.importorskip("yaml")

from bench.concealed.build import drawn, make_study  # noqa: E402
from bench.concealed.campaign import campaign  # noqa: E402
from bench.concealed.catalogue import EFFECTS, ways_of  # noqa: E402
from bench.concealed.draft import draft_of  # noqa: E402
from bench.concealed.robots import NAMES, robot  # noqa: E402
from bench.concealed.spec import Truth, WorldSpec  # noqa: E402
from bench.concealed.world import Run, World  # noqa: E402

DERIVATIVES = 20.0  # [Hz] up to which positions are differentiated
BOTH_SIDES = 6.0  # [Hz] of the filter on torque and model alike
STEP = 0.004  # [s]


class Judge:
    """Reads a study folder as a stranger would and asks Pinocchio what the torques should be."""

    def __init__(self, folder: Path, truth: Truth) -> None:
        self.study = yaml.safe_load((folder / "study.yaml").read_text())
        self.model = pin.buildModelFromUrdf(str(folder / "robot.urdf"))
        self.joints = [str(name) for name in self.model.names][1:]
        armature = dict(zip(self.study["joints"], self.study["rotor_inertia"], strict=True))
        self.armature = np.array([armature[name] for name in self.joints])
        noise = dict(zip(truth.joints, truth.noise["tau"], strict=True))
        self.noise = np.array([noise[name] for name in self.joints])
        self.folder = folder

    def motion(self, file: str) -> dict[str, np.ndarray]:
        """Filtered positions, their derivatives and torques on an even grid, ends cut off."""
        text = self.folder / file
        names = text.read_text().split("\n", 1)[0].split(",")
        table = np.loadtxt(text, delimiter=",", skiprows=1)
        time = np.arange(table[0, 0], table[-1, 0], STEP)
        low_pass = signal.butter(3, DERIVATIVES, fs=1.0 / STEP, output="sos")

        def channel(name: str) -> np.ndarray:
            columns = [
                np.interp(time, table[:, 0], table[:, names.index(f"{name}.{joint}")])
                for joint in self.joints
            ]
            return signal.sosfiltfilt(low_pass, np.column_stack(columns), axis=0)

        q = channel("q")
        dq = np.gradient(q, STEP, axis=0)
        ddq = np.gradient(dq, STEP, axis=0)
        cut = slice(150, -150)
        return {
            "time": time[cut],
            "q": q[cut],
            "dq": dq[cut],
            "ddq": ddq[cut],
            "tau": channel("tau")[cut],
        }

    def residual(self, file: str, model: object | None = None) -> tuple[dict, np.ndarray]:
        """Motion and torque less inverse dynamics, (T, n)."""
        model = self.model if model is None else model
        motion, data = self.motion(file), model.createData()
        believed = np.array(
            [
                pin.rnea(model, data, q, dq, ddq) + self.armature * ddq
                for q, dq, ddq in zip(motion["q"], motion["dq"], motion["ddq"], strict=True)
            ]
        )
        low_pass = signal.butter(3, BOTH_SIDES, fs=1.0 / STEP, output="sos")
        return motion, signal.sosfiltfilt(low_pass, motion["tau"] - believed, axis=0)

    def index(self, truth: Truth) -> int:
        """The hidden effect's joint."""
        return self.joints.index(truth.effects[0]["joints"][0])

    @property
    def files(self) -> list[str]:
        return [recording["file"] for recording in self.study["recordings"]]


def made(folder: Path, **fields: object) -> tuple[Judge, Truth]:
    truth = make_study(folder, WorldSpec(**{"seed": 7, **fields}))
    return Judge(folder, truth), truth


def rms(values: np.ndarray) -> np.ndarray:
    return np.sqrt(np.mean(values**2, axis=0))


@pytest.mark.parametrize("name", ["panda", "ur10", "h1_arm", "random3", "random7"])
def test_clean_torques_are_pinocchios_to_the_noise_floor(tmp_path: Path, name: str) -> None:
    judge, _ = made(tmp_path / "a", effect="clean", robot=name)
    for file in judge.files:
        motion, residual = judge.residual(file)
        assert np.all(rms(residual) < 0.4 * judge.noise)
        assert np.all(rms(motion["ddq"]) > 0.1)  # it did move


@pytest.mark.parametrize("seed", [3, 4, 5, 6])
def test_coulomb_friction_is_half_the_gap_between_directions(tmp_path: Path, seed: int) -> None:
    judge, truth = made(tmp_path / "a", effect="coulomb_friction", robot="random4", seed=seed)
    joint, level = judge.index(truth), truth.effects[0]["parameters"]["level"]
    forwards, backwards = [], []
    for file in judge.files:
        motion, residual = judge.residual(file)
        speed = motion["dq"][:, joint]
        steady = np.abs(motion["ddq"][:, joint]) < 1.0
        forwards.append(residual[(speed > 0.1) & steady, joint])
        backwards.append(residual[(speed < -0.1) & steady, joint])
    gap = np.median(np.concatenate(forwards)) - np.median(np.concatenate(backwards))
    assert gap == pytest.approx(2.0 * level, rel=0.04)


def extra_torque(effect: str, p: dict, motion: dict, joint: int, judge: Judge) -> np.ndarray:
    """The catalogue's equation for one joint, written out once more."""
    t, q, v, a, tau = (motion[key] for key in ("time", "q", "dq", "ddq", "tau"))
    t, q, v, a, tau = t, q[:, joint], v[:, joint], a[:, joint], tau[:, joint]
    side = np.sign(v)
    if effect == "viscous_friction":
        return p["coefficient"] * v
    if effect == "asymmetric_friction":
        return 0.5 * (p["level_difference"] * np.abs(side) + p["viscous_difference"] * np.abs(v))
    if effect == "friction_drift":
        return p["extra"] * np.exp(-t / p["time_constant"]) * side
    if effect == "coulomb_friction":
        return p["level"] * side
    if effect == "rotor_inertia":
        return p["inertia"] * a
    if effect == "torque_ripple":
        return p["amplitude"] * np.cos(p["harmonic"] * q + p["phase"])
    if effect == "position_dependent_spring":
        way = q - p["onset"]
        return p["stiffness"] * np.where((p["side"] == 0) | (p["side"] * way > 0), way, 0.0)
    if effect == "torque_gain":
        return tau * (1.0 - 1.0 / p["gain"])
    if effect == "torque_offset":
        return np.full_like(q, p["offset"])
    if effect == "load_dependent_friction":
        load = tau / (1.0 + p["coefficient"] * side * np.sign(tau)) - judge.armature[joint] * a
        return p["coefficient"] * np.abs(load) * side
    raise AssertionError(effect)


@pytest.mark.parametrize(
    "effect",
    [
        "viscous_friction",
        "asymmetric_friction",
        "friction_drift",
        "rotor_inertia",
        "torque_ripple",
        "position_dependent_spring",
        "torque_gain",
        "torque_offset",
        "load_dependent_friction",
    ],
)
def test_torques_obey_the_equation_with_the_truths_parameters(tmp_path: Path, effect: str) -> None:
    judge, truth = made(tmp_path / "a", effect=effect, robot="random3", seed=9)
    joint = judge.index(truth)
    for file in judge.files:
        motion, residual = judge.residual(file)
        model = sum(
            extra_torque(entry["effect"], entry["parameters"], motion, joint, judge)
            for entry in truth.effects
        )
        low_pass = signal.butter(3, BOTH_SIDES, fs=1.0 / STEP, output="sos")
        moving = np.abs(motion["dq"][:, joint]) > 0.05  # sign(dq) is another thing near rest
        before = residual[moving, joint]
        after = before - signal.sosfiltfilt(low_pass, model)[moving]
        assert np.std(before) + abs(np.mean(before)) > 2.0 * judge.noise[joint]
        assert np.median(np.abs(after)) < 0.3 * judge.noise[joint]


def tips(judge: Judge, file: str) -> tuple[np.ndarray, np.ndarray]:
    """Positions of the joints and measured tips, (T, n) and (T, 3), some rows."""
    names = (judge.folder / file).read_text().split("\n", 1)[0].split(",")
    table = np.loadtxt(judge.folder / file, delimiter=",", skiprows=1)[::25]
    q = np.column_stack([table[:, names.index(f"q.{joint}")] for joint in judge.joints])
    return q, np.column_stack([table[:, names.index(f"tip.{axis}")] for axis in "xyz"])


def forward(model: object, q: np.ndarray) -> np.ndarray:
    data, frame, result = model.createData(), model.getFrameId("tool"), []
    for row in q:
        pin.framesForwardKinematics(model, data, row)
        result.append(data.oMf[frame].translation.copy())
    return np.array(result)


@pytest.mark.parametrize("effect", ["joint_offset", "joint_coupling", "kinematic_error"])
def test_tips_are_where_the_truths_geometry_has_them(tmp_path: Path, effect: str) -> None:
    seed = next(
        seed
        for seed in range(40)
        if draft_of(WorldSpec(seed=seed, effect=effect, robot="random4")).sensors.tip
    )
    judge, truth = made(tmp_path / "a", effect=effect, robot="random4", seed=seed)
    p, joint, model = truth.effects[0]["parameters"], judge.index(truth), judge.model.copy()
    q, measured = tips(judge, judge.files[0])
    before = measured - forward(model, q)
    if effect == "joint_offset":
        q[:, joint] += p["offset"]
    elif effect == "joint_coupling":
        q[:, joint] += p["ratio"] * q[:, judge.joints.index(truth.effects[0]["joints"][1])]
    else:
        place = model.jointPlacements[joint + 1]
        turn = pin.rpy.rpyToMatrix(p["rx"], p["ry"], p["rz"])
        shift = np.array([p["dx"], p["dy"], p["dz"]])
        model.jointPlacements[joint + 1] = pin.SE3(place.rotation @ turn, place.translation + shift)
    after = measured - forward(model, q)
    assert np.max(rms(before)) > 3.0 * truth.noise["tip"]
    assert np.all(rms(after) < 1.2 * truth.noise["tip"])


def test_a_push_is_a_force_on_the_link_in_its_window(tmp_path: Path) -> None:
    judge, truth = made(tmp_path / "a", effect="external_contact", robot="random5", size=20.0)
    push = truth.effects[0]
    (file,), (low, high) = push["recordings"], push["window"]
    motion, residual = judge.residual(file)
    inside = (motion["time"] > low + 0.4) & (motion["time"] < high - 0.4)
    outside = (motion["time"] < low - 0.4) | (motion["time"] > high + 0.4)
    name = "tool" if push["kind"] == "tip" else push["links"][0]
    force = np.array([push["parameters"][f"force_{axis}"] for axis in "xyz"])
    data, frame, expected = judge.model.createData(), judge.model.getFrameId(name), []
    for q in motion["q"][inside]:
        J = pin.computeFrameJacobian(judge.model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
        expected.append(-J[:3].T @ force)
    assert np.all(rms(residual[outside]) < 0.5 * judge.noise)
    assert np.max(rms(residual[inside]) / judge.noise) > 5.0
    assert np.all(rms(residual[inside] - expected) < 0.8 * judge.noise)


def test_stribeck_friction_is_more_at_creeping_speed(tmp_path: Path) -> None:
    judge, truth = made(
        tmp_path / "a", effect="stribeck_friction", robot="random3", hide="corner", size=20.0
    )
    joint = judge.index(truth)
    stribeck, coulomb = (entry["parameters"] for entry in truth.effects)
    ratios = []
    for file in judge.files:
        motion, residual = judge.residual(file)
        speed = motion["dq"][:, joint]
        some = (np.abs(speed) > 0.02) & (np.abs(motion["ddq"][:, joint]) < 0.05)
        level = coulomb["level"] + stribeck["extra"] * np.exp(
            -((speed[some] / stribeck["speed"]) ** 2)
        )
        ratios.append(residual[some, joint] * np.sign(speed[some]) / level)
    assert np.median(np.concatenate(ratios)) == pytest.approx(1.0, abs=0.05)


def test_a_payload_is_the_body_the_truth_says(tmp_path: Path) -> None:
    judge, truth = made(tmp_path / "a", effect="payload", robot="panda")
    p = truth.effects[0]["parameters"]
    body = pin.Inertia(
        p["mass"],
        np.array([p["com_x"], p["com_y"], p["com_z"]]),
        np.diag([p["ixx"], p["iyy"], p["izz"]]),
    )
    loaded = judge.model.copy()
    loaded.inertias[7] = loaded.inertias[7] + body
    file = judge.files[0]
    assert np.max(rms(judge.residual(file)[1]) / judge.noise) > 3.0
    assert np.all(rms(judge.residual(file, loaded)[1]) < 0.4 * judge.noise)


def test_a_tilted_base_is_gravity_turned_as_the_truth_says(tmp_path: Path) -> None:
    judge, truth = made(tmp_path / "a", effect="gravity_direction", robot="iiwa14")
    p = truth.effects[0]["parameters"]
    R = pin.rpy.rpyToMatrix(p["tilt_x"], 0.0, 0.0) @ pin.rpy.rpyToMatrix(0.0, p["tilt_y"], 0.0)
    tilted = judge.model.copy()
    tilted.gravity.linear = R.T @ np.array([0.0, 0.0, -9.81])
    file = judge.files[0]
    assert np.max(rms(judge.residual(file)[1]) / judge.noise) > 3.0
    assert np.all(rms(judge.residual(file, tilted)[1]) < 0.4 * judge.noise)


def test_a_wrong_link_is_the_difference_the_truth_says(tmp_path: Path) -> None:
    judge, truth = made(tmp_path / "a", effect="link_inertial_error", robot="random5")
    p, k = truth.effects[0]["parameters"], int(truth.effects[0]["links"][0][4:])
    true = judge.model.copy()
    vector = true.inertias[k].toDynamicParameters()  # m, m c, Ixx Ixy Iyy Ixz Iyz Izz at origin
    keys = ["d_mass", *(f"d_first_moment_{a}" for a in "xyz")]
    keys += [f"d_i{a}" for a in ("xx", "xy", "yy", "xz", "yz", "zz")]
    vector = vector + np.array([p[key] for key in keys])
    true.inertias[k] = pin.Inertia.FromDynamicParameters(vector)
    file = judge.files[0]
    assert np.max(rms(judge.residual(file)[1]) / judge.noise) > 3.0
    assert np.all(rms(judge.residual(file, true)[1]) < 0.4 * judge.noise)


def test_a_link_with_backlash_stays_within_its_stops() -> None:
    draft = draft_of(WorldSpec(seed=2, effect="backlash", robot="random3"))
    (effect,) = drawn(draft)
    effect = replace(effect, gap=0.01)
    world = World(draft.arm, draft.armature, draft.control, draft.sensors, (effect,))
    runs = [Run(world, motion, 0, np.random.default_rng(0)) for motion in draft.motions]
    hinge = runs[0].model.joint(f"s{effect.joint}").qposadr[0]
    play = np.concatenate([run.simulate().qpos[:, hinge] for run in runs])
    assert np.max(np.abs(play)) < 0.005 + 3e-4
    assert np.min(play) < -0.0045
    assert np.max(play) > 0.0045


def test_an_elastic_joint_yields_by_its_load_over_its_stiffness() -> None:
    draft = draft_of(WorldSpec(seed=4, effect="joint_elasticity", robot="panda"))
    (effect,) = drawn(draft)
    world = World(draft.arm, draft.armature, draft.control, draft.sensors, (effect,))
    run = Run(world, draft.motions[0], 0, np.random.default_rng(0))
    rows = run.simulate()
    wound = rows.qpos[:, run.model.joint(f"s{effect.joint}").qposadr[0]]
    slow = np.max(np.abs(rows.dq), axis=1) < 0.02
    load = np.array([world.believed.gravity(q)[effect.joint] for q in rows.q[slow]])
    assert np.median(np.abs(wound[slow] * effect.stiffness + load)) < 0.1 * np.median(np.abs(load))


def test_the_same_spec_gives_the_same_bytes(tmp_path: Path) -> None:
    spec = WorldSpec(seed=11, effect="torque_ripple", hide="second", robot="random2")
    first = make_study(tmp_path / "a", spec, tmp_path / "truth")
    second = make_study(tmp_path / "b", spec, tmp_path / "truth")
    assert first == second
    files = sorted(path.name for path in (tmp_path / "a").iterdir())
    assert files == sorted(path.name for path in (tmp_path / "b").iterdir())
    for name in files:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    other = make_study(tmp_path / "c", replace(spec, seed=12))
    assert other.effects != first.effects


@pytest.mark.parametrize("name", ["panda", "h1_arm"])
def test_a_study_gives_nothing_away(tmp_path: Path, name: str) -> None:
    spec = WorldSpec(seed=5, effect="payload", hide="no_torque", robot=name)
    make_study(tmp_path / "s" / "00005", spec, tmp_path / "truth")
    files = sorted(path.name for path in (tmp_path / "s" / "00005").iterdir())
    recordings = [file for file in files if file.startswith("rec")]
    assert files == [*recordings, "robot.urdf", "study.yaml"]
    text = "".join((tmp_path / "s" / "00005" / file).read_text() for file in files).lower()
    words = set(re.findall(r"[a-z]+", text))
    assert not words & {"payload", "truth", "hidden", "effect", "hide", "seed", "mesh", "visual"}
    assert not words & {"panda", "shoulder", "elbow", "torso", "collision", "geometry"}
    header = (tmp_path / "s" / "00005" / "rec1.csv").read_text().split("\n", 1)[0]
    assert not re.search(r"\btau", header)
    assert (tmp_path / "truth" / "00005.json").exists()


@pytest.mark.parametrize("effect", EFFECTS)
def test_every_effect_can_be_hidden_in_every_way_that_suits_it(effect: str) -> None:
    for way in ways_of(effect):
        spec = WorldSpec(seed=21, effect=effect, hide=way, robot="random2")
        drawn_effects = drawn(draft_of(spec))
        assert drawn_effects[0].id == effect
        assert len(drawn_effects) == (2 if way == "second" else 1)


def test_links_of_all_robots_are_bodies() -> None:
    for name in NAMES:
        for seed in range(5):
            arm = robot(name, np.random.default_rng(seed))
            for link in arm.links:
                least, middle, most = np.linalg.eigvalsh(link.inertia)
                assert link.mass > 0.0
                assert least > 0.0
                assert least + middle >= most * (1.0 - 1e-9)


def test_a_campaign_has_every_effect_and_enough_clean_studies() -> None:
    specs = list(campaign(1_000_000))
    assert len(specs) >= 600
    assert {spec.effect for spec in specs} >= set(EFFECTS)
    assert sum(spec.effect == "clean" for spec in specs) >= 100
    assert len({spec.seed for spec in specs}) == len(specs)
    assert {spec.robot for spec in specs} == set(NAMES)


def test_the_worlds_share_no_code_with_the_diagnosis() -> None:
    for path in (Path(__file__).parents[2] / "bench" / "concealed").glob("*.py"):
        imports = re.findall(r"^\s*(?:from|import)\s+(\S+)", path.read_text(), re.MULTILINE)
        assert not [name for name in imports if name.startswith("pdoik")]


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"effect": "magic"}, "effect is 'magic'"),
        ({"robot": "r2d2"}, "robot is 'r2d2'"),
        ({"hide": "cupboard"}, "hide is 'cupboard'"),
        ({"effect": "backlash", "hide": "corner"}, "hide is 'corner'"),
        ({"effect": "outside:magic"}, "kind is 'magic'"),
    ],
)
def test_a_spec_that_cannot_be_made_is_refused(tmp_path: Path, fields: dict, message: str) -> None:
    spec = WorldSpec(**{"seed": 0, "robot": "random2", **fields})
    with pytest.raises(ValueError, match=message):
        make_study(tmp_path / "a", spec)
