"""Identification as textbooks have it: least squares with the model's regressor and friction.

With fair knowledge: the model's bodies are kept and friction is free, or they are free as well,
with a tenth of their size as prior. What is clear by its errors, of blocks of a second, is said.

And our library of effects with the plainest search, forwards by the Bayesian criterion: no
background, no held-out rows, no sessions left out, no simulation.
"""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.sim2real.frame.tracks import (
    Array,
    Believed,
    Track,
    joint_columns,
    stacked,
    study_tracks,
)
from pdoik.sim2real import load_study
from pdoik.sim2real.identify import candidates, estimates
from pdoik.sim2real.motion import Balances, prepare
from pdoik.sim2real.regression import Fit, OneMore, repeats_of

STEP = 0.02  # between rows [s]
BLOCK = 1.0  # rows within which count as one for errors [s]
SURE = 0.95  # stated for what is said
CLEAR = 4.0  # errors from which a figure is said
TENTH = 0.1  # prior of bodies, relative
ROUNDS = 2  # the second by what the first leaves of each joint

OWN = (
    ("rotor_inertia", "inertia"),
    ("viscous_friction", "coefficient"),
    ("coulomb_friction", "level"),
    ("torque_offset", "offset"),
)
"""What the columns of a joint are."""


def finding(
    effect: str, joints: list[str], links: list[str], parameters: dict[str, Any]
) -> dict[str, Any]:
    """As diagnoses have them, of methods that state no confidence."""
    place = {"effect": effect, "joints": joints, "links": links, "window": None}
    return {**place, "parameters": parameters, "confidence": SURE, "equivalents": []}


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution:
    """Figures and their covariance."""

    beta: Array
    cov: Array

    def said(self, k: int) -> dict[str, Any]:
        value, std = float(self.beta[k]), float(np.sqrt(self.cov[k, k]))
        interval = [value - 1.96 * std, value + 1.96 * std]
        return {"value": value, "std": std, "interval95": interval}

    def clear(self, k: int) -> bool:
        """Whether a figure is larger than its error."""
        return abs(self.beta[k]) > CLEAR * np.sqrt(self.cov[k, k])


def named_by_regression(study: Path, bodies: bool) -> list[dict[str, Any]]:
    """Findings: friction, offset and rotor of every joint; links' errors where bodies are free."""
    loaded = load_study(study)
    fit, _ = study_tracks(loaded)
    n = len(loaded.joints)
    believed = Believed(loaded.robot, loaded.joints, loaded.rotor_inertia)
    Y = np.concatenate([_columns(believed, track, bodies) for track in fit])
    residual = stacked(fit, "residual", STEP)
    block = np.concatenate(
        [
            1000 * i + (np.arange(len(track.q[track.every(STEP)])) * STEP / BLOCK).astype(int)
            for i, track in enumerate(fit)
        ]
    )
    prior = np.zeros(Y.shape[2])
    if bodies:
        inertias = [believed.model.inertias[i].toDynamicParameters() for i in range(1, n + 1)]
        size = np.abs(np.concatenate(inertias))
        prior[4 * n :] = 1.0 / (TENTH * np.maximum(size, 0.05 * size.max())) ** 2
    solution = _solved(Y, residual, block, prior)
    found = []
    for j, name in enumerate(loaded.joints):
        for k, (effect, figure) in enumerate(OWN):
            at = 4 * j + k
            positive = effect == "torque_offset" or solution.beta[at] > 0.0
            if solution.clear(at) and positive:
                found.append(finding(effect, [name], [], {figure: solution.said(at)}))
    for i in range(n if bodies else 0):
        at = 4 * n + 10 * i
        link = believed.model.names[i + 1].replace("joint", "link")
        if any(solution.clear(at + k) for k in range(4)):
            found.append(finding("link_inertial_error", [], [link], {"d_mass": solution.said(at)}))
    weights = [abs(next(iter(each["parameters"].values()))["value"]) for each in found]
    return [found[i] for i in np.argsort(weights)[::-1]]


def _columns(believed: Believed, track: Track, bodies: bool) -> Array:
    rows = track.every(STEP)
    q, dq, ddq = track.q[rows], track.dq[rows], track.ddq[rows]
    own = joint_columns(dq, ddq)
    return np.concatenate([own, believed.regressor(q, dq, ddq)], axis=2) if bodies else own


def _solved(Y: Array, residual: Array, block: Array, prior: Array) -> Solution:
    """Weighted least squares; errors by sums over blocks."""
    weight = 1.0 / np.std(residual, axis=0)
    beta = np.zeros(Y.shape[2])
    inverse = np.eye(len(beta))
    for _ in range(ROUNDS):
        A = (Y * weight[:, None]).reshape(-1, len(beta))
        gram = A.T @ A + np.diag(prior)
        size = np.sqrt(np.diag(gram)) + 1e-12  # columns of one size keep the inverse exact
        inverse = np.linalg.inv(gram / np.outer(size, size) + 1e-9 * np.eye(len(beta)))
        inverse /= np.outer(size, size)
        beta = inverse @ (A.T @ (residual * weight).ravel())
        weight = 1.0 / np.maximum(np.std(residual - Y @ beta, axis=0), 1e-9)
    left = (residual - Y @ beta) * weight
    scores = np.einsum("tjp,tj->tp", Y * weight[:, None], left)
    sums = np.array([scores[block == each].sum(axis=0) for each in np.unique(block)])
    root = sums @ inverse
    return Solution(beta=beta, cov=root.T @ root)


MOST = 40  # terms


def named_stepwise(study: Path) -> list[dict[str, Any]]:
    """Findings in the order in which they were taken."""
    prepared = prepare(load_study(study))
    balances = prepared.fit
    pool = candidates(balances)
    fit = Fit(balances, ())
    price = float(np.log(balances.count))
    while len(fit.terms) < MOST:
        taken = {t.key for t in fit.terms}
        one_more = OneMore(fit)
        worth = [
            (one_more.gain(t) - price * (t.width + len(t.shape)), t)
            for t in pool
            if t.key not in taken
        ]
        best = max(worth, key=lambda each: each[0], default=None)
        if best is None or best[0] <= 0.0:
            break
        fit = fit.extended(best[1])
    values = estimates(Fit(_as_noisy(balances, fit), fit.terms), fit.terms, 0)
    links = () if prepared.body is None else prepared.body.links
    return [
        finding(
            term.effect,
            [prepared.study.joints[j] for j in term.place.joints],
            [] if term.place.link is None else [links[term.place.link]],
            {name: asdict(each) for name, each in values[i].items()},
        )
        for i, term in enumerate(fit.terms)
    ]


def _as_noisy(balances: Balances, fit: Fit) -> Balances:
    """With what a fit leaves as noise, rows that err alike counted once."""
    noise = {}
    for key in fit.design:
        rows, left = fit.rows[key], fit.residual(key) * balances.sigma[key]
        if len(rows):
            alike = repeats_of(balances, rows, left)
            noise[key] = float(np.sqrt(np.mean(left**2) * alike)) or balances.sigma[key]
    return balances.with_noise(noise)
