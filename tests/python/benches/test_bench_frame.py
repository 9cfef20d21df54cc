"""What kinds of worlds share: files of studies and truths, blind runs, what scores count alike."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("dask", reason="pip install 'pdoik[bench]'")

from bench.ik.lines import jobs_of
from bench.sim2real.frame import blind
from bench.sim2real.frame.score import agrees, alternatives, by_confidence, covered, error_of, rank
from bench.sim2real.frame.streams import stream
from bench.sim2real.frame.study_files import write_study, write_truth


def test_a_truth_has_its_studys_name_and_lies_elsewhere(tmp_path: Path) -> None:
    study = tmp_path / "studies" / "world0001"
    with pytest.raises(ValueError, match="outside"):
        write_truth(study / "truth", study, {})
    write_truth(tmp_path / "sealed", study, {"b": 1, "a": 2})
    text = (tmp_path / "sealed" / "world0001.json").read_text()
    assert text == '{\n "a": 2,\n "b": 1\n}\n'
    study.mkdir(parents=True)
    write_study(study, "<robot/>", {"robot": "robot.urdf", "joints": ["a"]})
    assert (study / "study.yaml").read_text() == "robot: robot.urdf\njoints: [a]\n"
    assert (study / "robot.urdf").read_text() == "<robot/>"


def test_random_numbers_depend_on_the_seed_and_on_every_word() -> None:
    first = stream(3, "panda", "noise").random()
    assert stream(3, "panda", "noise").random() == first
    others = (stream(4, "panda", "noise"), stream(3, "ur10", "noise"), stream(3, "panda", "order"))
    assert first not in [each.random() for each in others]


@pytest.mark.parametrize("file", ["study.yaml", "compare.yaml"])
def test_a_study_with_a_simulator_is_compared_and_another_is_diagnosed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, file: str
) -> None:
    probe = tmp_path / "probe.py"
    probe.write_text(
        "import json, sys\njson.dump({'study': sys.argv[1]}, open(sys.argv[2], 'w'))\n"
    )
    study = tmp_path / "pair"
    study.mkdir()
    (study / file).write_text("")
    monkeypatch.setattr(blind, "ONE", probe)
    assert blind.blind(study)["study"] == f"study/{file}"


def test_scores_count_ranks_equivalents_intervals_and_confidences() -> None:
    findings = [{"effect": "a", "equivalents": [{"effect": "b"}]}, {"effect": "c"}]
    assert rank(findings, lambda each: each["effect"] == "c") == 2
    assert rank(findings, lambda each: each["effect"] == "b") == 0
    assert [each["effect"] for each in alternatives(findings[0])] == ["a", "b"]
    assert [each["effect"] for each in alternatives(findings[0], 0)] == ["a"]
    estimate = {"value": 1.0, "interval95": [0.9, 1.1]}
    assert agrees(estimate, 1.05, 0.0)
    assert not agrees(estimate, 1.2, 0.1)
    assert agrees(estimate, 1.2, 0.2)
    assert covered(estimate, error_of(estimate, 1.09))
    assert not covered(estimate, error_of(estimate, 1.2))
    turn = error_of({"value": 3.1}, -3.1, turns=True)
    assert turn == pytest.approx(6.2 - 2.0 * np.pi)
    stated = np.array([0.5, 0.89, 0.9, 1.0])
    found = {name: inside.tolist() for name, inside in by_confidence(stated, (0.6, 0.9, 1.0))}
    assert found == {
        "0.6 to 0.9": [False, True, False, False],
        "0.9 to 1": [False, False, True, True],
    }


def test_jobs_have_all_that_the_axes_name_the_last_one_fastest() -> None:
    jobs = jobs_of(2, 7, row=("free", "axis"), robot=("two FR3",))
    assert list(jobs) == [
        "000-free-two_FR3",
        "000-axis-two_FR3",
        "001-free-two_FR3",
        "001-axis-two_FR3",
    ]
    assert jobs["001-axis-two_FR3"] == {"index": 1, "seed": 7, "row": "axis", "robot": "two FR3"}
    assert jobs_of(1, 7) == {"000": {"index": 0, "seed": 7}}
