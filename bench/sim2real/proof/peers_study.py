"""One study and its recordings beyond it: every method fitted, every prediction judged."""

import importlib
import json
import tempfile
import time
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from bench.sim2real.concealed.beyond import CONDITIONS, make_beyond
from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.frame.tracks import Array, Track, beyond_track, smooth, study_tracks
from bench.sim2real.proof.peers_methods import (
    Predictor,
    boosting,
    least_squares,
    network,
    nothing,
    ours,
    pysindy,
)
from bench.sim2real.proof.peers_sysid import sysid
from pdoik.sim2real import Study, load_study

Method = Callable[[Study, list[Track], list[Track]], Predictor]

METHODS: dict[str, tuple[Method, str]] = {  # and the module that each needs
    "nothing": (nothing, ""),
    "ours": (ours, ""),
    "mujoco.sysid": (sysid, "mujoco.sysid.report.defaults"),
    "least squares": (least_squares, ""),
    "pysindy": (pysindy, "pysindy"),
    "gradient boosting": (boosting, "sklearn"),
    "network": (network, "sklearn"),
}
MOVING = 0.05  # speed above which friction is not what happens to hold a joint [rad/s]
COLUMNS = ("validate", *CONDITIONS)


def missing() -> dict[str, str]:
    """Methods whose module is not installed, and why in words."""
    result = {}
    for name, (_, module) in METHODS.items():
        try:
            importlib.import_module(module) if module else None
        except ImportError as error:
            result[name] = f"{name} is left out: {error}"
    return result


class Case:
    """A study's folder with what goes beyond it and the sealed truth of the torques."""

    def __init__(self, folder: Path, spec: WorldSpec) -> None:
        """Made in an empty folder; the study itself holds no truth."""
        truth = make_study(folder / "study", spec, folder / "truth", clean=True)
        self.facts = make_beyond(folder / "beyond", spec)
        self.effects, self.size = truth.effects, truth.size
        self.study = load_study(folder / "study" / "study.yaml")
        self.fit, self.choose = study_tracks(self.study)
        self.columns = {"validate": self.choose} | {
            name: [beyond_track(self.study, folder / "beyond", name)] for name in CONDITIONS
        }
        self.noise = np.array(truth.noise["tau"])
        self._order = [int(name.removeprefix("joint")) - 1 for name in self.study.joints]
        with np.load(folder / "truth" / "study.npz") as near:
            self._truth = dict(near)
        with np.load(folder / "beyond" / "truth.npz") as far:
            self._truth |= dict(far)

    def true(self, track: Track) -> Array:
        """What the drives would report without noise, (T, n) on the track's grid."""
        key = Path(track.recording.name).stem
        times = track.recording.start + track.recording.time
        known, tau = self._truth[f"{key}_time"], self._truth[f"{key}_tau"]
        return np.stack([np.interp(times, known, tau[:, k]) for k in self._order], axis=1)

    def errors(self, predict: Predictor, speed: float = 0.0) -> dict[str, Array]:
        """Root mean square error per joint (n,) in each column, over the torque's noise.

        Only of rows in which a joint is at least so fast [rad/s]; NaN where it never is.
        """
        result = {}
        for column, tracks in self.columns.items():
            total, count = np.zeros(len(self.noise)), np.zeros(len(self.noise))
            for track in tracks:
                left = smooth(predict(track) - self.true(track), track.period)[track.inner]
                fast = np.abs(track.dq[track.inner]) >= speed
                total += np.sum(left**2 * fast, axis=0)
                count += np.sum(fast, axis=0)
            result[column] = np.sqrt(total / np.where(count > 0, count, np.nan)) / self.noise
        return result


def affected(errors: dict[str, Array]) -> Array:
    """Joints (n,) whose held-out torque the given model misses by more than the noise.

    All of them where there is none, as with a delay of commands.
    """
    seen = errors["validate"] > 1.0
    return seen if seen.any() else np.ones_like(seen)


def run_study(job: dict[str, Any]) -> list[dict[str, Any]]:
    spec = WorldSpec(**job["spec"])
    rows = []
    with tempfile.TemporaryDirectory(prefix="pdoik-peers-") as folder, one_thread():
        case = Case(Path(folder), spec)
        given = nothing(case.study, case.fit, case.choose)
        before, moved = case.errors(given), case.errors(given, MOVING)
        joints = affected(before)
        for name in job["methods"]:
            begin, said = time.perf_counter(), ""
            try:
                predict = METHODS[name][0](case.study, case.fit, case.choose)
                said = getattr(predict, "said", "")
                seconds = time.perf_counter() - begin
                predict = remembered(predict)
                errors, moving = case.errors(predict), case.errors(predict, MOVING)
            except Exception as error:  # a study that a method breaks on counts as not improved
                seconds, errors, moving = time.perf_counter() - begin, before, moved
                said = f"{type(error).__name__}: {error}"
            row = {
                **asdict(spec),
                "world_size": case.size,
                "method": name,
                "affected": int(joints.sum()),
                "seen": bool(np.any(before["validate"] > 1.0)),
                "seconds": seconds,
                "said": said,
                "hidden": json.dumps(case.effects),
                "facts": json.dumps(case.facts),
            }
            for c in COLUMNS:
                judged = scores(errors[c], before[c], joints)
                judged |= {
                    f"moving_{key}": value
                    for key, value in scores(moving[c], moved[c], joints).items()
                }
                rows.append(row | {"column": c} | judged)
    return rows


def scores(errors: Array, before: Array, joints: Array) -> dict[str, Any]:
    """Scores of one method in one column; `before` are the errors of the model as given."""
    return {
        "ratio": float(np.nanmedian((errors / before)[joints])),
        "floors": float(np.nanmedian(errors[joints])),
        "all_joints": float(np.sqrt(np.nanmean(errors**2))),
        "errors": json.dumps([round(float(x), 4) for x in errors]),
    }


def remembered(predict: Predictor) -> Predictor:
    known: dict[int, Array] = {}

    def once(track: Track) -> Array:
        if id(track) not in known:
            known[id(track)] = predict(track)
        return known[id(track)]

    return once


def one_thread() -> Any:
    """One processor for everybody, so that seconds can be compared."""
    try:
        from threadpoolctl import threadpool_limits
    except ImportError:
        return nullcontext()
    return threadpool_limits(1)
