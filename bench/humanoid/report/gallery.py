"""Pictures of an experiment's dodges: run once more from their stored plans."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from bench.humanoid.report.figure import write_figure
from bench.humanoid.report.foreseen import dodged
from bench.humanoid.report.pictures import strip, write_film, write_gif
from bench.humanoid.trials.experiment import Experiment, Job
from bench.humanoid.trials.predict import Trial, follow_plan
from bench.humanoid.trials.store import plan_of, throw_of
from bench.humanoid.world.model import build_world

AFTER = 2.0  # what a picture shows behind the throw [s]
_ORDER = ("paper", "welded", "free", "balanced")


def dodges(experiment: Experiment) -> list[Job]:
    """Trials whose plan dodged, the paper's own set-up first."""
    found = [
        job
        for job in experiment.jobs()
        if job.mode == "predict" and dodged(experiment.store.get(job.name) or {})
    ]
    return sorted(found, key=lambda job: (_ORDER.index(job.setup.name), job.index))


def draw_film(experiment: Experiment, found: Sequence[Job]) -> list[Path]:
    """film.mp4 and film.gif of the first dodge."""
    trial = _again(experiment, found[0])
    folder = experiment.store.folder
    paths = [folder / "film.mp4", folder / "film.gif"]
    write_film(trial.world, trial.run, paths[0])
    write_gif(trial.world, trial.run, paths[1])
    return paths


def draw_figure(experiment: Experiment, found: Sequence[Job]) -> list[Path]:
    """figure.png: the first dodge, and key frames of one with each other object."""
    job = found[0]
    trial = _again(experiment, job)
    others: dict[str, Job] = {}
    for other in found[1:]:
        if other.setup == job.setup and _object(experiment, other) != _object(experiment, job):
            others.setdefault(_object(experiment, other), other)
    more = {}
    for name, other in others.items():
        run = _again(experiment, other)
        more[_title(experiment, other, name)] = strip(run.world, run.run, n=4)
    path = experiment.store.folder / "figure.png"
    write_figure(trial, path, _title(experiment, job, _object(experiment, job)), more)
    return [path]


def _object(experiment: Experiment, job: Job) -> str:
    return str((experiment.store.get(job.name) or {})["throw"]["object_name"])


def _title(experiment: Experiment, job: Job, name: str) -> str:
    speed = (experiment.store.get(job.name) or {})["throw"]["speed"]
    points = len(experiment.things[name].cloud)
    return f"{name}, {points} points, {speed:.1f} m/s"


def _again(experiment: Experiment, job: Job) -> Trial:
    record = experiment.store.get(job.name) or {}
    throw = throw_of(record["throw"])
    world = build_world(job.setup, experiment.things[throw.object_name])
    return follow_plan(world, plan_of(record["plan"]), throw, AFTER)
