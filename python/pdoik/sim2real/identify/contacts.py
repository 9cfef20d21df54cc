"""Windows of time in which something pushes the robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..effects.contacts import ORIGIN, ExternalContact
from ..motion import Place, Shape
from ..regression import Fit, Term, gains_alone, term_of, wald
from ..thresholds import DiagnosisThresholds

_ACTS = 1e-3  # numerics: of its largest part, from which a contact acts
_AS_MUCH = 0.98  # numerics: of the most, that links whose origins meet explain
_LENGTHS = (0.4, 0.8, 1.6, 3.2, 6.4)  # of the windows tried [s]


@dataclass(frozen=True, kw_only=True)
class Window:
    """A stretch of a recording, the link pushed, and what a constant force explains there.

    Of that gain what each row costs is taken off: it may be less than nothing.
    """

    motion: int
    link: int
    shape: Shape  # at which point of the link
    begin: float
    end: float
    gain: float


def contact_term(fit: Fit) -> Term | None:
    """The clearest contact in what a fit leaves; None where there is none."""
    points = _points(fit)
    windows = [w for link, shape in points for w in _scan(fit, link, shape) if _new(fit, w)]
    best = clearest(windows)
    if best is None:
        return None
    b = fit.balances
    place = Place(
        link=best.link,
        recording=b.motions[best.motion].recording.name,
        window=(best.begin, best.end),
    )
    term = term_of(b, CATALOGUE[ExternalContact.id], place, best.shape)
    if term is None or best.end - best.begin < b.thresholds.diagnosis.shortest:
        return None
    return term if stands(fit.extended(term), term) else None


def clearest(windows: Sequence[Window]) -> Window | None:
    """The window that explains most, links from the tip to the base; None where none does.

    Links whose origins meet cannot be distinguished: the one nearest the base stands for them.
    """
    most = max((window.gain for window in windows), default=0.0)
    if most <= 0.0:
        return None
    return next(window for window in reversed(windows) if window.gain >= _AS_MUCH * most)


def stands(fit: Fit, term: Term) -> bool:
    """Whether a contact, the fit's last term, is clear with all the others in the fit."""
    least = fit.balances.thresholds.diagnosis
    gain, rows, elsewhere, harm = 0.0, 0, 0.0, 0.0
    beta = fit.beta[-term.width :]
    for key, column in term.columns.items():
        part = column[fit.rows[key]] @ beta / fit.balances.sigma[key]
        if not len(part):
            continue  # a joint that stood still
        at = np.abs(part) > _ACTS * np.abs(part).max()
        after = fit.residual(key)[at]
        before = after + part[at]
        harm = max(harm, float(after @ after - 1.1 * (before @ before)) - 2.0 * len(after))
        gain += float(part @ part)
        rows += int(at.sum())
        elsewhere += float(np.sum(fit.residual(key)[~at] ** 2)) / max(int((~at).sum()), 1)
    if harm > least.push_harm * gain:
        return False  # it would make a joint worse
    usual = elsewhere / max(len(term.columns), 1)
    if gain < least.rare * usual * rows:
        return False  # no larger than what is left at other times
    large = gain > least.push_gain and gain > rows
    return large and wald(fit, term) > least.push_t


def pauses(fit: Fit, term: Term) -> bool:
    """Whether it is clear that a contact, the fit's last term, does not last all recording long.

    Extended before and after its window, it must explain less by as much as a contact must gain.
    """
    b, place = fit.balances, replace(term.place, window=(-np.inf, np.inf))
    least = b.thresholds.diagnosis
    whole = term_of(b, CATALOGUE[ExternalContact.id], place, term.shape)
    if whole is None:
        return False
    beta, harm = fit.beta[-term.width :], 0.0
    for key, column in whole.columns.items():
        rows = fit.rows[key]
        outside = ~acting(term.columns[key][rows], least.little)
        left = fit.residual(key)[outside]
        part = column[rows[outside]] @ beta / b.sigma[key]
        harm += float(part @ part - 2.0 * (left @ part))
    return harm > least.push_gain


def acting(column: FloatArray, felt: float) -> NDArray[np.bool_]:
    """Rows in which more than a filter's ringing is felt, `felt` a share of the most, (N,)."""
    size = np.abs(column).max(axis=1, initial=0.0)
    return np.asarray(size > felt * size.max(initial=0.0))


def _new(fit: Fit, window: Window) -> bool:
    """Whether no contact of the same recording and time is there already."""
    name = fit.balances.motions[window.motion].recording.name
    return not any(
        term.place.recording == name
        and term.place.window is not None
        and term.place.window[0] < window.end
        and window.begin < term.place.window[1]
        for term in fit.terms
    )


def _points(fit: Fit) -> list[tuple[int, Shape]]:
    """Links' origins and the tip, that first."""
    first = fit.balances.motions[0]
    body = first.body
    if body is None or first.base is not None:  # a free base shares every push with the feet
        return []
    links = [int(link) for link in np.argsort(-body.depth) if body.depth[link] >= 2 or body.n == 1]
    points: list[tuple[int, Shape]] = [(link, ()) for link in links]
    return [*points[:1], (body.last, ORIGIN), *points[1:]]


def _scan(fit: Fit, link: int, shape: Shape) -> list[Window]:
    """The best window of each recording, if it is clear enough."""
    b, least = fit.balances, fit.balances.thresholds.diagnosis
    body = b.motions[0].body
    assert body is not None
    left, column, counts = _rows(fit, link, shape)
    found = []
    for m in range(len(b.motions)):
        span = slice(int(b.starts[m]), int(b.starts[m + 1]))
        time = b.time[span]
        step = float(time[1] - time[0])
        moment = np.einsum("nj,njk->nk", left[span], column[span])
        gram = np.einsum("njk,njl->nkl", column[span], column[span])
        square = np.sum(left[span] ** 2, axis=1)
        sums = [_sums(x) for x in (moment, gram, square, counts[span].astype(float))]
        best: Window | None = None
        for length in _LENGTHS:
            rows = max(4, round(length / step))
            firsts = np.arange(0, len(time) - rows, max(1, rows // 6))
            if not len(firsts):
                continue
            gains = _gains(sums, firsts, firsts + rows)
            top = int(np.argmax(gains))
            clear = gains[top] > least.rare * _third(gains)
            if (
                clear
                and _explains(least, sums, firsts[top], firsts[top] + rows)
                and (best is None or gains[top] > best.gain)
            ):
                best = Window(
                    motion=m,
                    link=link,
                    shape=shape,
                    begin=float(time[firsts[top]]),
                    end=float(time[firsts[top] + rows]),
                    gain=float(gains[top]),
                )
        if best is not None:
            found.append(_sharpened(least, best, sums, time))
    return found


def _third(gains: FloatArray) -> float:
    """The third highest gain of windows that do not overlap (six starts to a window's length)."""
    left = gains.copy()
    peaks = []
    for _ in range(3):
        at = int(np.argmax(left))
        peaks.append(float(left[at]))
        left[max(0, at - 6) : at + 7] = 0.0
    return peaks[-1]


def _gain(sums: list[FloatArray], first: int, last: int) -> float:
    """Gain of a constant force over rows first to last."""
    return float(_gains(sums, np.array([first]), np.array([last]))[0])


def _gains(sums: list[FloatArray], firsts: NDArray[np.intp], lasts: NDArray[np.intp]) -> FloatArray:
    """The same of many windows, (F,)."""
    moment, gram = (s[lasts] - s[firsts] for s in sums[:2])
    return gains_alone(moment, gram, 1e-6)[1]


def _explains(least: DiagnosisThresholds, sums: list[FloatArray], first: int, last: int) -> bool:
    """Whether a constant force explains most of what is there, and that is not little."""
    square, count = (s[last] - s[first] for s in sums[2:])
    gain = _gain(sums, first, last)
    return bool(
        count >= 6 and gain > least.push_gain and gain > least.most_of * square and gain > count
    )


def _sharpened(
    least: DiagnosisThresholds, window: Window, sums: list[FloatArray], time: FloatArray
) -> Window:
    """Both ends moved row by row to where the gain, less what a row costs, is highest."""
    first, last = (int(np.searchsorted(time, t)) for t in (window.begin, window.end))
    cost = 2.0

    def value(a: int, z: int) -> float:
        if a < 0 or z >= len(time) or z - a < 4:
            return -np.inf
        return _gain(sums, a, z) - cost * (z - a) if _explains(least, sums, a, z) else -np.inf

    best, improved = value(first, last), True
    while improved:
        improved = False
        for da, dz in ((-1, 0), (1, 0), (0, 1), (0, -1), (-4, 0), (4, 0), (0, 4), (0, -4)):
            if (v := value(first + da, last + dz)) > best + 1e-9:
                best, first, last, improved = v, first + da, last + dz, True
    return replace(window, begin=float(time[first]), end=float(time[last]), gain=best)


def _rows(fit: Fit, link: int, shape: Shape) -> tuple[FloatArray, FloatArray, NDArray[np.intp]]:
    """Residuals (N, n), torques per newton (N, n, 3) in sigmas, and how many joints count (N,)."""
    b = fit.balances
    left = np.zeros((b.count, b.n))
    column = np.zeros((b.count, b.n, 3))
    counts = np.zeros(b.count, dtype=np.intp)
    each = [m.link_jacobian(link, at_tip=not shape) for m in b.motions]
    jacobian = np.concatenate([b.thin(i, -values) for i, values in enumerate(each)])
    for j in range(b.n):
        key = ("torque", j)
        if key not in fit.design:
            continue
        rows = fit.rows[key]
        left[rows, j] = fit.residual(key)
        column[rows, j] = jacobian[rows, :, j] / b.sigma[key]
        counts[rows] += 1
    return left, column, counts


def _sums(values: FloatArray) -> FloatArray:
    zero = np.zeros((1, *values.shape[1:]))
    return np.concatenate([zero, np.cumsum(values, axis=0)])
