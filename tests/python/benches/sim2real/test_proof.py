"""The proof: planned, sealed, diagnosed blind and scored as it says."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

pytest.importorskip("mujoco")
pytest.importorskip("pinocchio")
pytest.importorskip("dask")
pytest.importorskip("pyarrow")
pytest.importorskip("matplotlib")

from bench.common import campaign
from bench.common.campaign import CampaignError
from bench.sim2real.concealed.spec import FIRST_PROOF_SEED, WorldSpec
from bench.sim2real.frame import blind as diagnose
from bench.sim2real.frame import sealed as sealing
from bench.sim2real.frame.score import as_diagnosis
from bench.sim2real.frame.sealed import SEALED, STUDIES
from bench.sim2real.proof import plan as plan_module
from bench.sim2real.proof import run
from bench.sim2real.proof.plan import QUICK, Plan, plan

# What is planned


def test_the_proof_has_six_hundred_studies_under_names_that_tell_nothing() -> None:
    whole = plan()
    assert whole.proof
    assert whole.seed == FIRST_PROOF_SEED
    assert len(whole.specs) >= 600
    assert list(whole.specs) == [f"study{k + 1:04d}" for k in range(len(whole.specs))]
    seeds = [spec.seed for spec in whole.specs.values()]
    assert len(set(seeds)) == len(seeds)
    near = pd.Series(seeds).corr(pd.Series(range(len(seeds))))
    assert abs(near) < 0.2  # the names' order is not the campaign's
    assert sum(spec.effect == "clean" for spec in whole.specs.values()) >= 100


def test_a_plan_and_its_digest_depend_on_the_seed_alone() -> None:
    assert plan(3000).digest() == plan(3000).digest()
    assert plan(3000).digest() != plan(3001).digest()
    assert list(plan(3000).specs.values()) != list(plan(3001).specs.values())


@pytest.mark.parametrize(
    ("seed", "quick", "every"),
    [(9_900, False, 1), (500_000, False, 1), (FIRST_PROOF_SEED, True, 1), (None, False, 5)],
)
def test_seeds_of_neither_kind_and_proofs_in_part_are_refused(
    seed: int | None, quick: bool, every: int
) -> None:
    with pytest.raises(ValueError, match="development"):
        plan(seed, quick=quick, every=every)


def test_the_quick_plan_has_every_kind_on_development_seeds() -> None:
    few = plan(quick=True)
    assert not few.proof
    assert {(spec.effect, spec.hide) for spec in few.specs.values()} == set(QUICK)
    assert len(few.specs) == len(QUICK)


# What is sealed


def of(out: Path, plan: Plan) -> run.Run:
    """A run whose tool has a digest of its own."""
    return run.Run(out=out, plan=plan, frozen={"tool": "0"})


@pytest.fixture
def sealed(tmp_path: Path) -> tuple[Path, Plan, dict[str, Any]]:
    """A run of two studies, by their files' names only."""
    specs = {f"study000{k}": WorldSpec(seed=k) for k in (1, 2)}
    small = Plan(seed=1, specs=specs)
    for name in specs:
        (tmp_path / STUDIES / name).mkdir(parents=True)
        (tmp_path / STUDIES / name / "study.yaml").write_text(f"robot: {name}\n")
        (tmp_path / SEALED).mkdir(exist_ok=True)
        (tmp_path / SEALED / f"{name}.json").write_text('{"effects": []}\n')
    return tmp_path, small, of(tmp_path, small).write_seal()


def test_the_seal_holds_while_nothing_changes(sealed: tuple[Path, Plan, dict]) -> None:
    out, small, written = sealed
    for name in small.specs:
        (out / "diagnoses").mkdir(exist_ok=True)
        (out / "diagnoses" / f"{name}.json").write_text('{"elsewhere": []}')
    assert list(of(out, small).opened()) == list(small.specs)
    assert of(out, small).seal() == written


@pytest.mark.parametrize("file", ["sealed/study0002.json", "studies/study0001/study.yaml"])
def test_a_truth_or_a_study_changed_afterwards_is_refused(
    sealed: tuple[Path, Plan, dict], file: str
) -> None:
    out, small, _ = sealed
    path = out / file
    path.write_text(path.read_text() + " ")
    with pytest.raises(CampaignError, match="not those that were sealed"):
        of(out, small).opened()


def test_truths_exchanged_between_studies_are_refused(sealed: tuple[Path, Plan, dict]) -> None:
    out, small, _ = sealed
    one, two = (out / SEALED / f"{name}.json" for name in small.specs)
    one.write_text('{"effects": [1]}\n')
    of(out, small).write_seal()
    first, second = one.read_bytes(), two.read_bytes()
    one.write_bytes(second)
    two.write_bytes(first)
    with pytest.raises(CampaignError, match="not those that were sealed"):
        of(out, small).opened()


def test_a_study_more_or_less_is_refused(sealed: tuple[Path, Plan, dict]) -> None:
    out, small, _ = sealed
    (out / SEALED / "study0003.json").write_text("{}")
    with pytest.raises(CampaignError, match="study0003"):
        of(out, small).opened()


def test_a_world_that_cannot_be_made_is_left_out_and_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*arguments: object) -> None:
        raise RuntimeError("no arm came through")

    monkeypatch.setattr(run, "ROOM", replace(run.ROOM, make_study=fails))
    job = {"out": str(tmp_path), "generator": run.ROOM.generator(), "room": run.__name__}
    job["name"] = "study0001"
    job |= {"spec": asdict(WorldSpec(seed=1))}
    (row,) = sealing.conceal(job)
    assert row["not_made"] == "no arm came through"
    assert list(tmp_path.iterdir()) == []
    one = Plan(seed=1, specs={"study0001": WorldSpec(seed=1)})
    written = of(tmp_path, one).write_seal(["study0001"])
    assert written["not_made"] == ["study0001"]
    assert of(tmp_path, one).names() == []
    with pytest.raises(RuntimeError, match="frozen"):
        sealing.conceal({**job, "generator": "another"})


def test_nothing_is_diagnosed_before_the_seal_nor_scored_before_a_diagnosis(
    sealed: tuple[Path, Plan, dict],
) -> None:
    out, small, _ = sealed
    proof = run.Run(out=out, plan=small)
    proof.freeze()
    with pytest.raises(CampaignError, match="no diagnosis yet"):
        proof.score()
    (out / sealing.SEAL).unlink()
    with pytest.raises(CampaignError, match="nothing was sealed"):
        proof.diagnose()


def test_a_run_goes_on_with_the_same_tool_and_plan_only(
    sealed: tuple[Path, Plan, dict], monkeypatch: pytest.MonkeyPatch
) -> None:
    out, small, _ = sealed
    run.Run(out=out, plan=small).freeze()
    run.Run(out=out, plan=small).freeze()
    monkeypatch.setattr(sealing, "tool_digest", lambda: "another")
    with pytest.raises(CampaignError, match="another tool"):
        run.Run(out=out, plan=small).freeze()


# Who sees what

PROBE = """
import json, os, sys
try:
    import bench
    seen = True
except ImportError:
    seen = False
text = " ".join([*sys.argv, *os.environ.values(), *sys.path, os.getcwd()])
said = {"files": sorted(os.listdir()), "bench": seen, "text": text, "elsewhere": []}
json.dump(said, open(sys.argv[2], "w"))
"""


def test_a_diagnosis_sees_its_study_and_nothing_of_the_truth(
    sealed: tuple[Path, Plan, dict], monkeypatch: pytest.MonkeyPatch
) -> None:
    out, small, _ = sealed
    probe = out.parent / f"{out.name}-probe.py"
    probe.write_text(PROBE)
    monkeypatch.setattr(diagnose, "ONE", probe)
    monkeypatch.setenv("TRUTH", str(out / SEALED))
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[4]))
    name = next(iter(small.specs))
    said = diagnose.blind(out / STUDIES / name)
    assert said["files"] == ["study"]
    assert not said["bench"]
    told = said["text"].replace(str(probe), "")
    assert SEALED not in told
    assert str(out) not in told
    assert name not in told


def test_files_opened_elsewhere_are_written_down(tmp_path: Path) -> None:
    code = (
        f"import runpy, json; one = runpy.run_path({str(diagnose.ONE)!r})\n"
        "seen = one['watch_files']()\n"
        f"open({str(tmp_path / 'truth.json')!r}).close()\n"
        "open('mine').close(); import decimal\n"
        "print(json.dumps(sorted(seen)))"
    )
    (tmp_path / "truth.json").write_text("{}")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "mine").write_text("")
    done = diagnose.subprocess.run(
        [sys.executable, "-I", "-c", code],
        cwd=tmp_path / "folder",
        capture_output=True,
        text=True,
        check=True,
    )
    assert json.loads(done.stdout) == [str(tmp_path / "truth.json")]


def test_jobs_reach_a_scheduler_that_cannot_import_this_package(tmp_path: Path) -> None:
    import cloudpickle  # as Dask does

    (tmp_path / "job").write_bytes(cloudpickle.dumps(campaign.by_value(plan_module.named)))
    code = (
        "import cloudpickle, sys; call = cloudpickle.load(open('job', 'rb'))\n"
        "assert not [name for name in sys.modules if name.startswith('bench')]\n"
        "try: call([])\n"
        "except TypeError: print('bench.sim2real.proof.plan' in sys.modules)"
    )
    done = diagnose.subprocess.run(
        [sys.executable, "-I", "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["True"]


@pytest.mark.parametrize(
    ("code", "longest", "said"),
    [
        ("raise MemoryError('too large')", 60.0, "status 1: MemoryError: too large"),
        ("import time; time.sleep(60)", 0.5, "no answer within 0.5 s"),
    ],
)
def test_a_crash_or_a_timeout_is_a_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, code: str, longest: float, said: str
) -> None:
    (tmp_path / "one.py").write_text(code)
    (tmp_path / "study").mkdir()
    monkeypatch.setattr(diagnose, "ONE", tmp_path / "one.py")
    result = diagnose.blind(tmp_path / "study", longest)
    assert result["error"] == said
    assert as_diagnosis(result)["verdict"] == f"error: {said}"


# All of it, in small


def test_two_worlds_from_concealment_to_score(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    specs = {
        "study0001": WorldSpec(seed=2, robot="random2"),
        "study0002": WorldSpec(seed=1, effect="viscous_friction", robot="random2"),
    }
    small = Plan(seed=1, specs=specs)

    def here(
        proof: run.Run, stage: str, settings: object, function: Any, jobs: dict
    ) -> pd.DataFrame:
        return pd.DataFrame([row for job in jobs.values() for row in function(job)])

    monkeypatch.setattr(run.Run, "stage", here)  # without a cluster
    proof = run.Run(out=tmp_path, plan=small)
    proof.freeze()
    proof.conceal()
    proof.diagnose()
    proof.score()
    rows = pd.read_parquet(tmp_path / "studies.parquet").set_index("name")
    assert rows.right.all()
    assert rows.loc["study0002", "first"] == "viscous_friction"
    assert 0.9 < rows.loc["study0002", "over_true"] < 1.1
    assert not rows.loc["study0002", "by_floor"]
    assert rows.loc["study0002", "replay_after"] <= rows.loc["study0002", "replay_before"]
    tables = (tmp_path / "tables.md").read_text()
    assert proof.seal()["truths"] in tables
    assert "these figures prove nothing" in tables
    assert json.loads((tmp_path / "diagnoses" / "study0001.json").read_text())["elsewhere"] == []
    truth = tmp_path / SEALED / "study0002.json"
    truth.write_text(truth.read_text().replace("viscous", "coulomb"))
    with pytest.raises(CampaignError, match="not those that were sealed"):
        proof.score()
