"""The tables of a study's keys: their examples are read as a study, and nothing else is."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from command_line import run
from pdoik.errors import LoadError
from pdoik.recordings import Keys, units_from
from pdoik.sim2real.study import GAINS, given_controller, read_part, trust_from
from pdoik.sim2real.study import key_tables as tables  # inside: the tables are tested whole


def example_of(table: Keys) -> dict[str, object]:
    return {name: yaml.safe_load(key.example) for name, key in table.items()}


def test_each_key_has_words_and_an_example_in_yaml() -> None:
    for title, table in tables.reference().items():
        assert table, title
        for name, key in table.items():
            assert key.kind, name
            assert key.words, name
            assert yaml.safe_load(key.example) is not None, name


def test_examples_of_a_study_are_one(tmp_path: Path) -> None:
    path = tmp_path / "study.yaml"
    path.write_text(yaml.safe_dump(example_of(tables.STUDY)))
    content = read_part(path)
    assert set(content) == set(tables.STUDY)
    assert trust_from(example_of(tables.TRUST)).torque == 0.01
    assert units_from(content["units"], "study").factor("tau") == pytest.approx(1e-3)
    path.write_text(yaml.safe_dump({"robots": "arm.urdf"}))
    with pytest.raises(LoadError, match="unknown key 'robots'; nearest: 'robot'"):
        read_part(path)


@pytest.mark.parametrize("kind", [*GAINS])
def test_examples_of_a_controller_are_one(kind: str) -> None:
    own = {"voltage": tables.VOLTAGE, "table": tables.TABLE}.get(kind, {})
    content = example_of({**tables.LAW, **{g: tables.GAINS[g] for g in GAINS[kind]}, **own})
    content = {  # of one joint
        name: value[:1] if isinstance(value, list) and name != "table" else value
        for name, value in content.items()
    }
    told = given_controller({**content, "type": kind}, ("j1",))
    assert told is not None
    assert told.type == kind
    assert set(told.gains) == set(GAINS[kind])


def test_they_are_printed() -> None:
    done = run("study", "keys")
    assert done.exit_code == 0, done.output
    for table in tables.reference().values():
        for name in table:
            assert f"  {name}: " in done.output
