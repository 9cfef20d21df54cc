"""A sensor noisier than it should be is named and measured; what is as it should be is not."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import WorldSpec
from pdoik.sim2real import Finding, diagnose
from pdoik.sim2real.channels import check_channels
from pdoik.sim2real.motion import prepare
from pdoik.sim2real.study import load_study

HIDDEN = [(7205, "random3", "dq"), (7206, "random6", "tau")]


def noisy(folder: Path) -> list[Finding]:
    check = check_channels(prepare(load_study(folder / "study.yaml")))
    return [f for f in check.findings if f.effect == "sensor_noise"]


def changed(folder: Path, into: Path, change: Callable[[pd.DataFrame], None]) -> Path:
    """A copy of the study in `folder` with every table changed in place."""
    shutil.copytree(folder, into)
    for path in sorted(into.glob("*.csv")):
        table = pd.read_csv(path)
        change(table)
        table.to_csv(path, index=False)
    return into


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three joints as their model, with commands and speeds in the recordings."""
    folder = tmp_path_factory.mktemp("machine") / "study"
    make_study(folder, WorldSpec(seed=7005, robot="random3"))
    assert {"dq.joint2", "tau.joint2", "tau_cmd.joint2"} <= set(pd.read_csv(folder / "rec1.csv"))
    return folder


@pytest.mark.parametrize(("seed", "robot", "channel"), HIDDEN)
def test_a_noisy_sensor_is_the_one_thing_that_is_found(
    tmp_path: Path, seed: int, robot: str, channel: str
) -> None:
    spec = WorldSpec(seed=seed, effect="sensor_noise", robot=robot)
    (hidden,) = make_study(tmp_path / "study", spec, tmp_path / "truth").effects
    assert hidden["channel"] == channel
    diagnosis = diagnose(tmp_path / "study" / "study.yaml")
    (finding,) = diagnosis.findings
    assert finding.effect == "sensor_noise"
    assert list(finding.joints) == hidden["joints"]
    assert finding.evidence.channels == (channel,)
    assert finding.evidence.validation_gain > 0.9
    estimate, true = finding.parameters["std"], hidden["parameters"]["std"]
    assert estimate.interval95[0] < true < estimate.interval95[1]
    assert estimate.value == pytest.approx(true, rel=0.1)
    assert estimate.unit == {"dq": "rad/s", "tau": "N m"}[channel]
    assert f"{channel}.{hidden['joints'][0]}" in finding.statement
    assert diagnosis.verdict == "mismatch_explained"


def test_noise_that_the_controller_acted_on_is_told_from_noise_of_the_recording(
    machine: Path, tmp_path: Path
) -> None:
    study = yaml.safe_load((machine / "study.yaml").read_text())
    kd = study["controller"]["kd"][study["joints"].index("joint2")]
    rng = np.random.default_rng(1)
    std = 2.5e-3  # twice what the sensor has: far too little to stand out by itself

    def fed_back(table: pd.DataFrame) -> None:
        noise = rng.normal(0.0, std, len(table))
        table["dq.joint2"] += noise
        table["tau_cmd.joint2"] -= kd * noise

    def logged(table: pd.DataFrame) -> None:
        table["dq.joint2"] += rng.normal(0.0, std, len(table))

    assert noisy(machine) == []
    assert noisy(changed(machine, tmp_path / "fed_back", fed_back)) == []
    (finding,) = noisy(changed(machine, tmp_path / "logged", logged))
    assert finding.joints == ("joint2",)
    assert "not in what its controller commanded" in finding.statement
    assert finding.values["std"] == pytest.approx(std, rel=0.15)


def test_a_torque_is_noisy_beside_the_others_not_by_itself(machine: Path, tmp_path: Path) -> None:
    names = [f"joint{k}" for k in (1, 2, 3)]
    table = pd.read_csv(machine / "rec1.csv")
    noise = {n: float(np.std(np.diff(table[f"tau.{n}"] - table[f"tau_cmd.{n}"]))) for n in names}
    rng = np.random.default_rng(2)

    def louder(*which: str) -> Callable[[pd.DataFrame], None]:
        def change(table: pd.DataFrame) -> None:
            for name in which:
                table[f"tau.{name}"] += rng.normal(0.0, 15.0 * noise[name], len(table))

        return change

    assert noisy(changed(machine, tmp_path / "all", louder(*names))) == []
    (finding,) = noisy(changed(machine, tmp_path / "one", louder("joint3")))
    assert finding.joints == ("joint3",)
    assert finding.values["std"] == pytest.approx(15.0 * noise["joint3"], rel=0.1)
    assert "cannot be seen" in finding.statement


def test_what_an_arm_hums_with_is_no_noise(machine: Path, tmp_path: Path) -> None:
    """It is in one part of the spectrum; as much noise is in all of it."""
    rng = np.random.default_rng(3)
    rate = 1.0 / float(np.median(np.diff(pd.read_csv(machine / "rec1.csv")["time"])))

    def humming(table: pd.DataFrame) -> None:
        phase = 2.0 * np.pi * 0.35 * rate * table["time"] + 0.3 * np.cumsum(
            rng.normal(size=len(table))
        )
        table["tau.joint3"] += 2.0 * np.sin(phase)

    def louder(table: pd.DataFrame) -> None:
        table["tau.joint3"] += rng.normal(0.0, 2.0 / np.sqrt(2.0), len(table))

    assert noisy(changed(machine, tmp_path / "humming", humming)) == []
    (finding,) = noisy(changed(machine, tmp_path / "louder", louder))
    assert finding.joints == ("joint3",)


def test_a_wrong_unit_is_no_noise(machine: Path, tmp_path: Path) -> None:
    def degrees(table: pd.DataFrame) -> None:
        table["dq.joint1"] = np.degrees(table["dq.joint1"])

    assert noisy(changed(machine, tmp_path / "degrees", degrees)) == []


def test_a_late_drive_is_no_noise(machine: Path, tmp_path: Path) -> None:
    """Its torque is not what the speed's noise would make it now, but a moment later."""

    def late(table: pd.DataFrame) -> None:
        time = table["time"]
        table["tau.joint1"] = np.interp(time - 0.012, time, table["tau.joint1"])
        for name in [name for name in table if name.startswith("tau_cmd")]:
            del table[name]

    assert noisy(changed(machine, tmp_path / "late", late)) == []


def test_a_coarse_encoder_is_not_a_noisy_one(machine: Path, tmp_path: Path) -> None:
    """Rounding looks like noise of the same size; that positions lie on steps tells them apart."""
    fine, step = 2.5e-4, 4e-3
    rng = np.random.default_rng(4)

    def unheard(table: pd.DataFrame, of_second: float) -> None:
        for name in list(table):
            if name.startswith(("tau_cmd.", "q_des.", "dq_des.")):
                del table[name]
        for name, each in (("joint1", fine), ("joint2", of_second), ("joint3", fine)):
            table[f"q.{name}"] = np.round(table[f"q.{name}"] / each) * each

    def rounded(table: pd.DataFrame) -> None:
        unheard(table, step)

    def shaken(table: pd.DataFrame) -> None:
        table["q.joint2"] += rng.normal(0.0, step / np.sqrt(12.0), len(table))
        unheard(table, fine)

    coarse = changed(machine, tmp_path / "coarse", rounded)
    steps = load_study(coarse / "study.yaml").recordings[0].steps
    assert steps == pytest.approx([fine, step, fine], rel=0.01)
    assert noisy(coarse) == []
    (finding,) = noisy(changed(machine, tmp_path / "noisy", shaken))
    assert finding.joints == ("joint2",)


def test_a_joint_that_hums_in_its_motion_too_has_no_noisy_torque(
    machine: Path, tmp_path: Path
) -> None:
    """As much torque as a noisy sensor's, white as it is sampled, but the joint moves with it."""
    rng = np.random.default_rng(6)

    def noise_alone(table: pd.DataFrame) -> None:
        table["tau.joint2"] += rng.normal(0.0, 4.0, len(table))

    def humming(table: pd.DataFrame) -> None:
        noise_alone(table)
        table["dq.joint2"] += rng.normal(0.0, 0.3, len(table))

    (finding,) = noisy(changed(machine, tmp_path / "noisy", noise_alone))
    assert finding.variant == "torque"
    found = noisy(changed(machine, tmp_path / "humming", humming))
    assert [each.variant for each in found if each.variant == "torque"] == []
