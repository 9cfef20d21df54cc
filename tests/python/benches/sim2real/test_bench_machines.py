"""The second generation of worlds: machines with friction, gears and sensors in every joint."""

from __future__ import annotations

import json
from inspect import signature

import numpy as np
import pytest

pytest.importorskip("numba")
pin = pytest.importorskip("pinocchio")

from bench.sim2real.frame.arm import urdf  # noqa: E402
from bench.sim2real.frame.robots import robot  # noqa: E402
from bench.sim2real.machines import build, kinds  # noqa: E402
from bench.sim2real.machines.background import in_background  # noqa: E402
from bench.sim2real.machines.chain import bodies_in_base, chain_of, mass_matrix, poses  # noqa: E402
from bench.sim2real.machines.figures import Figures  # noqa: E402
from bench.sim2real.machines.held_out import draft_behind, rows_of  # noqa: E402
from bench.sim2real.machines.physics import STATES, friction, rates  # noqa: E402
from bench.sim2real.machines.plan import WorldSpec, spec_of  # noqa: E402
from bench.sim2real.machines.regression import named_by_regression  # noqa: E402
from bench.sim2real.machines.replayed import replays_of  # noqa: E402
from bench.sim2real.machines.score import score  # noqa: E402
from bench.sim2real.machines.simulate import torque_of  # noqa: E402
from bench.sim2real.machines.variants import VARIANTS  # noqa: E402
from bench.sim2real.machines.worlds import World  # noqa: E402
from pdoik.sim2real import Diagnosis, diagnose  # noqa: E402
from pdoik.sim2real.identify import Hypothesis, Model, Posterior  # noqa: E402
from pdoik.sim2real.thresholds import Thresholds  # noqa: E402
from sim2real_evidence_rows import add, believed, data_of, term  # noqa: E402

GRAVITY = np.array([0.0, 0.0, -9.81])


@pytest.mark.parametrize("name", ["panda", "ur10", "random3"])
def test_the_chains_dynamics_are_pinocchios(name: str) -> None:
    arm = robot(name, np.random.default_rng(3))
    model = pin.buildModelFromXML(urdf(arm))
    data, chain, n = model.createData(), chain_of(arm), arm.n
    for q, v, a in np.random.default_rng(0).normal(size=(5, 3, n)):
        expected = pin.rnea(model, data, q, v, a)
        assert np.allclose(torque_of(chain, q, v, a, GRAVITY), expected, atol=1e-6)
        R, p, z = np.empty((n, 3, 3)), np.empty((n, 3)), np.empty((n, 3))
        com, inertia, M = np.empty((n, 3)), np.empty((n, 3, 3)), np.empty((n, n))
        poses(chain, q, R, p, z)
        bodies_in_base(chain, R, p, com, inertia)
        mass_matrix(chain, p, z, com, inertia, M)
        upper = np.triu(pin.crba(model, data, q))
        assert np.allclose(M, upper + np.triu(upper, 1).T, atol=1e-7)


def test_stiff_gears_without_friction_move_like_a_rigid_arm() -> None:
    """Rotors and links together obey the mass matrix with the rotors' inertia added."""
    arm = robot("random3", np.random.default_rng(5))
    chain, n = chain_of(arm), arm.n
    figures = Figures.empty(n)
    for j in range(n):
        figures = figures.with_joint(j, rotor=0.2, stiffness=3e4, gear_damping=20.0)
    model = pin.buildModelFromXML(urdf(arm))
    data = model.createData()
    q, v = np.random.default_rng(1).normal(size=(2, n)) * 0.5
    torque = pin.rnea(model, data, q, np.zeros(n), np.zeros(n)) + 0.5
    y, dy = np.zeros(STATES * n + 2), np.zeros(STATES * n + 2)
    y[0::STATES][:n] = y[2::STATES][:n] = q
    y[1::STATES][:n] = y[3::STATES][:n] = v
    y[7::STATES][:n] = torque
    none, push = np.zeros(n), np.zeros(3)
    args = (torque, figures.joints, figures.whole, chain, none, none, push)
    step = 2e-5
    for _ in range(5000):  # 0.1 s by the midpoint rule
        rates(y, *args, dy)
        rates(y + 0.5 * step * dy, *args, dy)
        y += step * dy
    rigid_q, rigid_v = q.copy(), v.copy()
    for _ in range(5000):
        M = pin.crba(model, data, rigid_q)
        M = np.triu(M) + np.triu(M, 1).T + 0.2 * np.eye(n)
        a = np.linalg.solve(M, torque - pin.nle(model, data, rigid_q, rigid_v))
        rigid_v += step * a
        rigid_q += step * rigid_v
    assert np.allclose(y[2::STATES][:n], rigid_q, atol=2e-4)


def test_friction_follows_its_figures() -> None:
    figures = Figures.empty(1).with_joint(0, coulomb=4.0, stiction=2.0, viscous=1.5, bristle=1e-3)
    for speed in (0.01, 0.3, 2.0, -2.0):
        torque = friction(figures.joints[0], speed, np.sign(speed), 0.0, 0.0, 0.0, 0.0)[0]
        level = 4.0 + 2.0 * np.exp(-abs(speed) / 0.1)
        expected = np.sign(speed) * level + 1.5 * np.tanh(speed / 0.02) * abs(speed)
        assert torque == pytest.approx(expected, rel=1e-3)


def test_a_spec_gives_the_same_study_again(tmp_path) -> None:
    spec = WorldSpec(seed=5, faults=("coulomb_friction",), robot="random2")
    for name in ("a", "b"):
        build.make_study(tmp_path / name / "x", spec, tmp_path / name)
    files = sorted(path.relative_to(tmp_path / "a") for path in (tmp_path / "a").rglob("*.*"))
    assert len(files) >= 6
    for file in files:
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()
    found = named_by_regression(tmp_path / "a" / "x" / "study.yaml", bodies=True)
    rubbing = {each["joints"][0] for each in found if each["effect"] == "coulomb_friction"}
    assert rubbing == {"joint1", "joint2"}
    for each in found:
        for estimate in each["parameters"].values():
            low, high = estimate["interval95"]
            assert low <= estimate["value"] <= high
    study = (tmp_path / "a" / "x" / "study.yaml").read_text()
    assert "trust" not in study
    assert "controller" not in study


def test_the_true_law_leaves_little_of_held_out_torques(tmp_path) -> None:
    spec = WorldSpec(seed=5, faults=("viscous_friction",), robot="random2")
    truth = build.make_study(tmp_path / "x", spec, tmp_path)
    said = diagnose(tmp_path / "x" / "study.yaml")
    joints = json.loads(said.to_json())["joints"]
    rows = rows_of(World("x", tmp_path / "x" / "study.yaml", truth, {"joints": joints}))
    assert [row["joint"] for row in rows] == ["joint1", "joint2"]
    assert sum(row["faulty"] for row in rows) == 1
    for row in rows:
        assert row["before"] == joints[row["joint"]]["before"]
        assert row["true"] < 0.35 * row["before"]
        assert row["after"] < 2.0 * row["true"]
    truth["faults"][0]["parameters"] = {"coefficient": 1.0}
    with pytest.raises(ValueError, match="no draft has the truth's faults"):
        draft_behind(truth)


def test_every_kind_of_fault_can_be_drawn_and_moves_something(tmp_path) -> None:
    for kind in kinds.KINDS:
        draft = build.draft_of(WorldSpec(seed=11, faults=(kind,), robot="random3"))
        fault = draft.faults[0]
        parts = (fault.figures, fault.arm, fault.push, fault.log)
        assert any(part is not None for part in parts), kind
        assert fault.effect == "outside" or fault.parameters or kind == "kinematic_error"
    assert len(kinds.KINDS) >= 30
    assert len(kinds.OUTSIDE) >= 8


def test_the_plan_has_every_kind_and_worlds_without_fault() -> None:
    specs = [spec_of(2_000_000 + k) for k in range(200)]
    assert {kind for spec in specs for kind in spec.faults} == set(kinds.KINDS)
    assert sum(not spec.faults for spec in specs) == 20
    assert sum(len(spec.faults) == 2 for spec in specs) == 20


def finding(effect: str, joints: list[str], **parameters: float) -> dict:
    values = {
        name: {"value": value, "interval95": [0.9 * value, 1.1 * value]}
        for name, value in parameters.items()
    }
    return {
        "effect": effect,
        "joints": joints,
        "links": [],
        "window": None,
        "positions": None,
        "parameters": values,
        "equivalents": [],
        "confidence": 0.95,
    }


@pytest.fixture(scope="module")
def truth(tmp_path_factory) -> dict:
    folder = tmp_path_factory.mktemp("truth")
    spec = WorldSpec(seed=7, faults=("backlash",), robot="random3")
    return build.make_study(folder / "x", spec, None)


def test_background_is_right_and_a_fault_that_is_not_there_is_false(truth) -> None:
    truth = json.loads(json.dumps(truth))
    own = truth["background"][0]
    right = finding("coulomb_friction", ["joint1"], level=own["level"])
    wrong = finding("coulomb_friction", ["joint1"], level=5.0 * own["level"])
    assert in_background(right, truth) == (True, True)
    assert in_background(wrong, truth) == (True, False)
    assert in_background(finding("joint_offset", ["joint1"], offset=0.1), truth) == (False, False)


def test_an_unnamed_cause_at_a_link_is_felt_at_the_joints_that_carry_it(truth) -> None:
    truth = json.loads(json.dumps(truth))
    truth["faults"] = [{"effect": "outside", "kind": "slosh", "joints": [], "links": ["link2"],
                        "parameters": {}, "begins": None}]  # fmt: skip
    for joint, right in (("joint1", True), ("joint2", True), ("joint3", False)):
        said = {"seconds": 1.0, "diagnosis": {"verdict": "", "joints": {}, "notes": [],
                "findings": [finding("unknown", [joint])]}}  # fmt: skip
        row = score("x", truth, said)
        assert bool(row["right"]) == right
        assert bool(json.loads(row["faults"])[0]["unknown"]) == right


def test_scores_count_the_fault_its_place_and_what_is_false(truth) -> None:
    truth = json.loads(json.dumps(truth))
    fault = truth["faults"][0]
    gap = fault["parameters"]["gap"]
    said = {
        "seconds": 1.0,
        "diagnosis": {
            "verdict": "mismatch_explained",
            "findings": [
                finding("joint_offset", ["joint1"], offset=0.1),
                finding("backlash", fault["joints"], gap=gap),
            ],
            "joints": {},
            "notes": [],
        },
    }
    row = score("x", truth, said)
    (told,) = json.loads(row["faults"])
    assert (told["named"], told["listed"], told["sized"]) == (2, 2, 2)
    assert row["right"] == 1
    assert row["findings"] == 2
    assert row["alarm"]
    nothing = {"seconds": 1.0, "diagnosis": {**said["diagnosis"], "findings": []}}
    (told,) = json.loads(score("x", truth, nothing)["faults"])
    assert not told["named"]
    assert not told["listed"]


def arguments(function: object) -> list[str]:
    """Their names; the first is what each calls the object itself."""
    of = function.fget if isinstance(function, property) else function
    return list(signature(of).parameters)[1:]


def switch_off(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the variant replaces; where that is no longer there, it switches off nothing."""
    assert VARIANTS[name].replaced
    for owner, what, by in VARIANTS[name].replaced:
        assert type(vars(owner)[what]) is type(by)
        assert arguments(vars(owner)[what]) == arguments(by)
        monkeypatch.setattr(owner, what, by)


def test_what_is_switched_off_is_a_threshold_or_a_function_of_the_tool() -> None:
    defaults = {each.name: each.value for each in Thresholds()}
    for name, variant in VARIANTS.items():
        Thresholds().changed(variant.thresholds)
        assert all(defaults[key] != value for key, value in variant.thresholds.items()), name


def of_made_up_rows() -> tuple[Model, Model, Hypothesis]:
    """Ordinary physics, the same with a cause that explains nearly everything, and the cause."""
    rng = np.random.default_rng(0)
    data = data_of(rng)
    ordinary = [believed(rng, term(rng, 2), ordinary=True)]
    cause = believed(rng, term(rng, 3), size=30.0)
    add(data, cause.term, 20.0 / np.sqrt(cause.precision))
    return Model(data, ordinary), Model(data, [*ordinary, cause]), cause


def test_without_swaps_nothing_is_dropped_or_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    switch_off("no swaps", monkeypatch)
    search, state = object.__new__(Posterior), object()
    assert search._swept(state, None, set()) is state
    assert search._instead(state) is None


def test_fixed_noise_does_not_fall_where_a_cause_explains_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    less, more, _ = of_made_up_rows()
    assert all(more.noise[key] < 0.2 * less.noise[key] for key in less.noise)
    gained = more.log_evidence - less.log_evidence
    switch_off("fixed noise", monkeypatch)
    less, more, cause = of_made_up_rows()
    assert more.noise == pytest.approx(less.noise)
    assert less.with_(cause).noise == less.noise
    assert 0.0 < more.log_evidence - less.log_evidence < gained


def test_bic_pays_half_the_log_of_all_rows_for_a_figure(monkeypatch: pytest.MonkeyPatch) -> None:
    _, model, _ = of_made_up_rows()
    by_evidence, rows = model.log_evidence, 0.0
    likelihood = 0.0
    for key, series in model.data.series.items():
        rows += series.independent
        share = np.mean(model.left(key) ** 2) / model.noise[key]
        likelihood -= 0.5 * series.independent * (np.log(model.noise[key]) + share)
    switch_off("BIC", monkeypatch)
    assert model.log_evidence != pytest.approx(by_evidence)
    assert model.log_evidence == pytest.approx(likelihood - 0.5 * model.size * np.log(rows))


def test_replays_are_of_the_machine_and_behind_its_own_controller(tmp_path) -> None:
    """Without findings a model is as told; the machine on another day is nearer than that."""
    spec = WorldSpec(seed=20023, faults=(), robot="random2")
    truth = build.make_study(tmp_path / "study", spec)
    study = tmp_path / "study" / "study.yaml"
    said = Diagnosis(verdict="mismatch_unexplained", findings=(), joints={}, notes=())
    rows = replays_of(World("w", study, truth, json.loads(said.to_json())))
    assert [row.joint for row in rows] == truth["joints"]
    for row in rows:
        assert row.before == row.after or np.isnan(row.before)
        assert 0.0 < row.another_day < 0.1 * row.moved
        assert not row.faulty
