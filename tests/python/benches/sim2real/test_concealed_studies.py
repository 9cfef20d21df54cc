"""The worlds' files and campaigns: they repeat, give nothing away and leave nothing out."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco")
pytest.importorskip("pinocchio")

from bench.sim2real.concealed.build import drawn, make_study
from bench.sim2real.concealed.catalogue import EFFECTS, campaign, ways_of
from bench.sim2real.concealed.draft import draft_of
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.frame.robots import NAMES, robot


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
    for path in (Path(__file__).parents[4] / "bench/sim2real/concealed").glob("*.py"):
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
