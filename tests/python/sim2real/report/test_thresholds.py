"""The numbers that decide what a diagnosis says: each means something, is used, and can change."""

from __future__ import annotations

import ast
import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

import pdoik.sim2real
from pdoik.cli.commands import app
from pdoik.sim2real import Thresholds, diagnose
from sim2real_channels import study

PACKAGE = Path(pdoik.sim2real.__file__).parent


def names_used() -> Iterator[str]:
    """Attributes, and names in quotes, of all code but the thresholds' own."""
    for path in PACKAGE.rglob("*.py"):
        if path.parent.name == "thresholds":
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Attribute):
                yield node.attr
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                yield node.value


def test_every_threshold_has_a_meaning_and_a_source() -> None:
    for each in Thresholds():
        assert len(each.meaning.split()) > 1, each.name
        assert each.source, each.name
        assert each.value == each.default, each.name


def test_every_threshold_is_used() -> None:
    used = set(names_used())
    unused = [each.name for each in Thresholds() if not used.issuperset(each.name.split("."))]
    assert not unused


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("diagnosis.wort", 4.0, "diagnosis.worth"),
        ("worth", 4.0, "diagnosis.worth"),
        ("diagnosis.worth", "4", "expected a number"),
        ("diagnosis.worth", None, "expected a number"),
        ("diagnosis.worth", True, "expected a number"),
        ("diagnosis.worth", float("inf"), "expected a finite number"),
        ("diagnosis.worth", float("nan"), "expected a finite number"),
        ("noise.folds", 2.5, "expected a whole number"),
    ],
)
def test_what_is_no_threshold_is_refused(name: str, value: float, said: str) -> None:
    with pytest.raises(ValueError, match=said) as refused:
        Thresholds().changed({name: value})
    assert name.rpartition(".")[2] in str(refused.value)


def test_a_changed_one_leaves_the_others() -> None:
    changed = Thresholds().changed({"diagnosis.worth": 9.0})
    assert changed.diagnosis.worth == 9.0
    assert [a.name for a, b in zip(changed, Thresholds(), strict=True) if a != b] == [
        "diagnosis.worth"
    ]


def test_a_stricter_threshold_takes_a_finding_away_and_is_written_down(tmp_path: Path) -> None:
    rubbing = study(tmp_path, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    found = diagnose(rubbing)
    assert "coulomb_friction" in {each.effect for each in found.findings}
    stricter = diagnose(rubbing, thresholds=Thresholds().changed({"diagnosis.sure": 1e6}))
    assert "coulomb_friction" not in {each.effect for each in stricter.findings}
    written = [json.loads(each.to_json())["thresholds"] for each in (found, stricter)]
    assert [each["diagnosis"]["sure"] for each in written] == [3.0, 1e6]


def test_the_command_line_lists_them() -> None:
    listed = json.loads(CliRunner().invoke(app, ["thresholds", "--json"]).output)["thresholds"]
    assert [each["name"] for each in listed] == [each.name for each in Thresholds()]
    table = CliRunner().invoke(app, ["thresholds"])
    assert table.exit_code == 0
    assert "diagnosis.push_t" in table.output
