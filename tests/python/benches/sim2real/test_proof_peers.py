"""The comparison with peers: conditions beyond the fit, methods that help, tables that count."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco")
pytest.importorskip("pinocchio")
pytest.importorskip("pandas")

import mujoco
import pandas as pd

from bench.sim2real.concealed.beyond import CONDITIONS, make_beyond
from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.frame.arm import read_chain
from bench.sim2real.proof import peers_replays, peers_report, peers_study, peers_trajectories
from bench.sim2real.proof.peers_study import COLUMNS, METHODS, Case, affected

SPEC = WorldSpec(seed=4490, effect="coulomb_friction", robot="random2", size=20.0)


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Case:
    return Case(tmp_path_factory.mktemp("case"), SPEC)


def test_the_same_spec_goes_beyond_in_the_same_bytes(tmp_path: Path) -> None:
    spec = WorldSpec(seed=4491, effect="torque_ripple", robot="random2")
    facts = [make_beyond(tmp_path / name, spec) for name in ("a", "b")]
    assert facts[0] == facts[1]
    for name in (*(f"{name}.csv" for name in CONDITIONS), "robot_loaded.urdf", "conditions.json"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    with np.load(tmp_path / "a" / "truth.npz") as one, np.load(tmp_path / "b" / "truth.npz") as two:
        assert sorted(one) == sorted(two)
        for key in one:
            np.testing.assert_array_equal(one[key], two[key])


def test_a_study_is_the_same_whether_or_not_one_goes_beyond_it(tmp_path: Path) -> None:
    spec = WorldSpec(seed=4492, effect="viscous_friction", robot="random2")
    make_study(tmp_path / "before", spec)
    make_beyond(tmp_path / "beyond", spec)
    make_study(tmp_path / "after", spec)
    for path in (tmp_path / "before").iterdir():
        assert path.read_bytes() == (tmp_path / "after" / path.name).read_bytes()
        assert "load" not in path.name


def test_the_conditions_are_unlike_the_fit(case: Case) -> None:
    q = np.concatenate([track.recording.q for track in case.fit])
    dq = np.concatenate([track.dq for track in case.fit])
    for name in CONDITIONS:
        there = case.columns[name][0]
        assert there.recording.time[-1] > 15.0
        known = {row.tobytes() for row in q}
        assert not any(row.tobytes() in known for row in there.recording.q)
    fast, elsewhere = case.columns["faster"][0], case.columns["poses"][0]
    speeds = np.std(fast.dq, axis=0) / np.std(dq, axis=0)
    assert np.median(speeds) > 1.4
    assert speeds.min() > 1.1  # a joint near its drive's speed limit gains less
    outside = (elsewhere.q < q.min(axis=0)) | (elsewhere.q > q.max(axis=0))
    assert outside.mean() > 0.15


def test_everybody_is_told_of_the_load(case: Case) -> None:
    plain = read_chain(case.study.robot, "base", "tool")
    loaded = read_chain(case.columns["load"][0].urdf, "base", "tool")
    more = loaded.links[-1].mass - plain.links[-1].mass
    assert more == pytest.approx(case.facts["load"]["mass"], rel=1e-6)
    share = more / sum(link.mass for link in plain.links[-3:])
    assert 0.2 <= share <= 0.3
    for one, other in zip(plain.links[:-1], loaded.links[:-1], strict=True):
        assert one.mass == other.mass
    assert np.abs(case.columns["load"][0].load).max() > 0.1
    assert not case.columns["faster"][0].load.any()


def test_the_truth_is_what_was_measured_but_for_noise(case: Case) -> None:
    for tracks in case.columns.values():
        for track in tracks:
            noise = (track.recording.tau - case.true(track))[track.inner]
            np.testing.assert_allclose(np.std(noise, axis=0), case.noise, rtol=0.4)


@pytest.mark.parametrize("name", [name for name in METHODS if name != "nothing"])
def test_every_method_helps_where_a_joint_rubs(case: Case, name: str) -> None:
    method, module = METHODS[name]
    if module:
        pytest.importorskip(module)
    before = case.errors(METHODS["nothing"][0](case.study, case.fit, case.choose))
    joints = affected(before)
    after = case.errors(method(case.study, case.fit, case.choose))
    ratio = {column: np.median((after[column] / before[column])[joints]) for column in COLUMNS}
    assert ratio["validate"] < 0.75
    if name in ("ours", "mujoco.sysid", "least squares"):  # physics holds outside the data
        assert max(ratio.values()) < 0.6


def test_a_peer_that_is_not_installed_is_left_out_with_a_sentence(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    some = {"nothing": METHODS["nothing"], "rival": (METHODS["nothing"][0], "no_such_module")}
    monkeypatch.setattr(peers_study, "METHODS", some)
    assert list(peers_study.missing()) == ["rival"]
    assert "no_such_module" in peers_study.missing()["rival"]
    with pytest.raises(ImportError):
        importlib.import_module("no_such_module")


def test_a_method_that_breaks_counts_as_the_model_as_given(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def broken(*given: object) -> None:
        raise ValueError("no such luck")

    some = {"nothing": METHODS["nothing"], "rival": (broken, "")}
    monkeypatch.setattr(peers_study, "METHODS", some)
    spec = {"seed": 4493, "effect": "coulomb_friction", "robot": "random2"}
    rows = pd.DataFrame(peers_study.run_study({"spec": spec, "methods": list(some)}))
    assert len(rows) == 2 * len(COLUMNS)
    assert (rows.ratio == 1.0).all()
    assert (rows[rows.method == "rival"].said == "ValueError: no such luck").all()


def test_tables_say_who_is_lowest() -> None:
    errors = {("ours", 1): 1.0, ("rival", 1): 0.5, ("ours", 2): 1.0, ("rival", 2): 1.04}
    rows = pd.DataFrame(
        {
            "seed": seed,
            "effect": "coulomb_friction",
            "robot": "panda",
            "column": column,
            "method": method,
            "ratio": floors,
            "floors": floors,
            "seconds": 1.0,
            "said": "mismatch_explained",
        }
        for (method, seed), floors in errors.items()
        for column in COLUMNS
    )
    assert peers_report.levels(rows, 0.0).groupby(rows.method).mean().to_dict() == {
        "ours": 0.5,
        "rival": 1.0,
    }
    assert peers_report.levels(rows, 0.5).all()
    lost = peers_report.not_lowest(rows)
    assert len(lost) == len(COLUMNS)
    assert all("seed 1" in line and "rival 0.50" in line for line in lost)


def test_the_given_model_moves_alike_in_the_peer_s_simulation(case: Case) -> None:
    nothing = peers_replays.simulator_of("nothing", case)
    for name in ("validate", "load"):
        track = case.columns[name][0]
        ours = nothing(track)
        model = peers_trajectories.loaded_model(
            peers_trajectories.controlled(case.study), case.study, track.urdf
        )
        chunk = peers_trajectories.chunk_of(case.study, track.recording, track.urdf)
        theirs, _ = peers_trajectories.simulated(model, case.study, [chunk], np.zeros(2))[0]
        apart = np.sqrt(np.mean((theirs - ours)[track.inner] ** 2))
        wrong = np.sqrt(np.mean((track.recording.q - ours)[track.inner] ** 2))
        assert apart < 0.2 * wrong


def test_a_load_is_the_one_that_is_told(case: Case) -> None:
    track = case.columns["load"][0]
    spec = peers_trajectories.controlled(case.study)
    ours = peers_trajectories.loaded_model(spec, case.study, track.urdf)
    told = peers_trajectories.specification(track.urdf, case.study, list(case.study.joints))
    known = told.compile()
    q = np.array([0.4, -0.7])
    weights = []
    for model in (ours, known):
        data = mujoco.MjData(model)
        data.qpos[:], data.qvel[:] = q, [0.3, -0.5]
        mujoco.mj_forward(model, data)
        full = np.zeros((2, 2))
        mujoco.mj_fullM(model, data, full)
        weights.append(np.vstack([full, data.qfrc_bias]))
    np.testing.assert_allclose(weights[0], weights[1], rtol=1e-6, atol=1e-9)


def test_motions_are_tabled_by_share_and_by_study() -> None:
    rows = [
        {
            "seed": seed,
            "effect": "payload",
            "robot": ("ur10", "panda")[seed % 2],
            "method": method,
            "column": column,
            "mrad": value * (seed + 1),
            "seconds": 2.0,
            "said": "",
        }
        for seed in range(3)
        for column in COLUMNS
        for method, value in (("nothing", 2.0), ("ours", 0.1), ("mujoco.sysid", 1.0))
    ]
    text = peers_replays.report(pd.DataFrame(rows))
    assert "| ours | 0.050 [0.050, 0.050], lowest in 100 %" in text
    assert "lowest in 0 %" in text
    assert "| payload | ur10 | 2 / 0.1 / 1 |" in text
    assert "nan" not in text
