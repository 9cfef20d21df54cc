"""What the true model would leave: the hidden effects alone, refitted as the diagnosis fits.

Place, window and the parameters that enter nonlinearly are the truth's; the rest is refitted to the
recordings to fit, and judged on those held out, by the same balances as the diagnosis is.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.common.campaign import Job, Row
from bench.sim2real.frame.sealed import SEALED, STUDIES
from pdoik.sim2real import CATALOGUE, Prepared, load_study, prepare
from pdoik.sim2real.effects import Effect
from pdoik.sim2real.infer import preferred
from pdoik.sim2real.motion import Balances, Key, Place
from pdoik.sim2real.regression import TRUST, Fit, Term, trusted

Entry = Mapping[str, Any]  # of a truth's effects
Array = NDArray[np.float64]

OPEN_END = 60.0  # a truth's window that ends there goes on to the end [s]
EDGE = 0.05  # over which a window opens and closes [s] or [rad]
NO_MODEL = ("unknown", "lying_channel", "sensor_noise")  # nothing a balance could be fitted to


class NoTrueModelError(Exception):
    """The truth cannot be written as terms of the catalogue; the message says why."""


def refit(job: Job) -> list[Row]:
    """Held-out residual of each joint under the true model, or why there is none."""
    out, name = Path(job["out"]), str(job["name"])
    truth = json.loads((out / SEALED / f"{name}.json").read_text())
    try:
        left = true_residuals(out / STUDIES / name / "study.yaml", truth["effects"])
        return [{"name": name, "true": json.dumps(left), "why_not": ""}]
    except Exception as error:  # no true model is no failure of the diagnosis
        why = (
            str(error)
            if isinstance(error, NoTrueModelError)
            else f"{type(error).__name__}: {error}"
        )
        return [{"name": name, "true": "{}", "why_not": why}]


def true_residuals(study: Path, entries: list[Entry]) -> dict[str, float]:
    """Root mean square by joint on the held-out recordings."""
    prepared = prepare(load_study(study))
    if prepared.validate is None:
        raise NoTrueModelError("nothing was held out")
    model = TrueModel(prepared, entries)
    left = model.residual(prepared.validate)
    result = {}
    for j, name in enumerate(prepared.study.joints):
        key = next((k for k in preferred(j) if k in left), None)
        if key is not None and prepared.validate.mask[key].any():
            rows = prepared.validate.mask[key]
            result[name] = float(np.sqrt(np.mean(left[key][rows] ** 2)))
    return result


class TrueModel:
    """The truth's terms with the coefficients that suit the recordings to fit."""

    def __init__(self, prepared: Prepared, entries: list[Entry]) -> None:
        self.prepared = prepared
        self.gates: dict[int, Entry] = {}  # by id of the term
        self.events: list[Term] = []  # in held-out recordings, where alone they can be learned
        b = prepared.fit
        self.fit = Fit(b, trusted(b, prepared.study.trust.rigid_body))
        for entry in entries:
            if entry["effect"] in NO_MODEL or entry["effect"] not in CATALOGUE:
                raise NoTrueModelError(f"{entry['effect']} has no terms")
            for place in places(prepared, entry):
                self._add(entry, place)

    def residual(self, b: Balances) -> dict[Key, Array]:
        """What is left of other balances, (N,) per key."""
        left = {key: b.residual[key].copy() for key in b.keys}
        for term, beta in self.fit.weighted:
            name = "link_inertial_error" if term.effect == TRUST else term.effect
            columns = gated(b, CATALOGUE[name], term, self.gates.get(id(term), {}))
            for key, column in columns.items():
                left[key] -= column @ beta
        for term in self.events:
            _take_out(b, left, gated(b, CATALOGUE[term.effect], term, {}))
        return left

    def _add(self, entry: Entry, place: Place) -> None:
        """The variant of an effect that suits best: the truth does not say how it is modelled."""
        b = self.prepared.fit
        effect = CATALOGUE[entry["effect"]]
        best: Fit | None = None
        for shape in shapes(effect, b, place, entry["parameters"]):
            width = 1 if effect.fixed else None
            term = _term(b, effect, place, shape, entry, width)
            if term is None:
                continue
            fit = self.fit.extended(term)
            if best is None or fit.cost() < best.cost():
                best = fit
        if best is not None and best.cost() <= self.fit.cost():
            self.fit = best
            self.gates[id(best.terms[-1])] = entry
        elif place.recording is not None:
            self.events.append(
                Term(effect=effect.id, place=place, shape=(), columns={}, prior=np.zeros(3))
            )
        else:
            raise NoTrueModelError(f"{effect.id} has no columns that explain what was recorded")


def places(prepared: Prepared, entry: Entry) -> Iterator[Place]:
    """Where the truth puts an effect, as the diagnosis counts joints and links."""
    joints, body = list(prepared.study.joints), prepared.body
    at = tuple(joints.index(name) for name in entry["joints"])
    if entry["effect"] == "external_contact":
        for name in entry["recordings"] or ():
            window = (entry["window"][0], entry["window"][1])
            yield Place(link=body.links.index(entry["links"][0]), recording=name, window=window)
    elif entry["effect"] == "joint_coupling":
        yield Place(joints=at)
    elif at:
        yield from (Place(joints=(j,)) for j in at)
    elif entry["links"]:
        yield Place(link=body.links.index(entry["links"][0]))
    else:
        yield Place()


def shapes(
    effect: Effect, b: Balances, place: Place, values: Mapping[str, float]
) -> list[tuple[float, ...]]:
    """The truth's nonlinear parameters in every variant of the effect."""
    values = {**dict.fromkeys((p.name for p in effect.parameters), 0.0), **values}
    if effect.id == "command_delay":
        del values["time_constant"]  # of the servo, which no truth has
    tried = effect.shapes(b.motions, place)
    found = []
    for shape in [*tried, ()] if not tried or effect.id == "joint_offset" else tried:
        try:
            own = effect.coefficients(values, shape)[0]
        except (KeyError, ZeroDivisionError):
            continue
        if len(shape) > len(own):
            own = (*own, *shape[len(own) :])  # what only the recordings tell
        if len(own) == len(shape) or not shape:
            found.append(tuple(float(x) for x in own))
    return list(dict.fromkeys(found))


def gated(b: Balances, effect: Effect, term: Term, gate: Entry) -> dict[Key, Array]:
    """A term's columns on balances, nothing outside the truth's window."""
    columns = {
        key: values.copy() for key, values in b.compute(effect, term.place, term.shape).items()
    }
    window, positions = gate.get("window"), gate.get("position_window")
    if effect.id == "external_contact" or (window is None and positions is None):
        return columns
    weights = []
    for motion in b.motions:
        x, ends = (
            (motion.q[:, term.place.joints[0]], positions) if positions else (motion.time, window)
        )
        high = np.inf if not positions and ends[1] >= OPEN_END else ends[1]
        weights.append(np.clip(np.minimum(x - ends[0], high - x) / EDGE, 0.0, 1.0))
    parts: dict[Key, Array] = {}
    for i, (motion, weight) in enumerate(zip(b.motions, weights, strict=True)):
        for key, values in effect.columns(motion, term.place, term.shape).items():
            if key in columns:
                part = parts.setdefault(key, np.zeros_like(columns[key]))
                part[b.starts[i] : b.starts[i + 1]] = b.thin(i, values * weight[:, None])
    return parts


def _term(
    b: Balances,
    effect: Effect,
    place: Place,
    shape: tuple[float, ...],
    entry: Entry,
    width: int | None,
) -> Term | None:
    bare = Term(effect=effect.id, place=place, shape=shape, columns={}, prior=np.zeros(0))
    columns = {key: c for key, c in gated(b, effect, bare, entry).items() if np.any(c)}
    if not columns:
        return None
    width = width or next(iter(columns.values())).shape[1]
    return replace(bare, columns=columns, prior=effect.prior(width))


def _take_out(b: Balances, left: dict[Key, Array], columns: dict[Key, Array]) -> None:
    """An event is learned where it happened."""
    rows = {key: b.mask[key] for key in columns if b.mask[key].any()}
    if not rows:
        return
    design = np.vstack([columns[key][at] / b.sigma[key] for key, at in rows.items()])
    target = np.concatenate([left[key][at] / b.sigma[key] for key, at in rows.items()])
    beta = np.linalg.lstsq(design, target, rcond=None)[0]
    for key, column in columns.items():
        left[key] -= column @ beta
