"""Where a residual sits: its share by speed, direction, position, load and time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from .data import RegimeMap, ReportData

_BINS = {
    "speed": ("still", "slow", "medium", "fast"),
    "direction": ("backwards", "reversal", "forwards"),
    "position": ("low", "middle", "high"),
    "load": ("light", "medium", "heavy"),
    "time": ("first third", "middle", "last third"),
}
STILL = 0.03  # of the joint's fast speed
REVERSAL = 0.15  # [s] about a change of direction


def regime_map(data: ReportData) -> RegimeMap:
    """Share of each joint's squared residual, before the findings, on held-out recordings."""
    labels = tuple((quantity, label) for quantity, some in _BINS.items() for label in some)
    shares, visits = [], []
    for joint in range(len(data.joints)):
        places = _places(data, joint)
        square = np.concatenate([traces.before[:, joint] for traces in data.held_out]) ** 2
        known = np.isfinite(square)
        share, visited = [], []
        for quantity, bins in _BINS.items():
            index = np.where(known, places[quantity], -1)
            weight = [float(square[index == k].sum()) for k in range(len(bins))]
            count = [float(np.count_nonzero(index == k)) for k in range(len(bins))]
            share += [value / max(sum(weight), 1e-300) for value in weight]
            visited += [value / max(sum(count), 1.0) for value in count]
        shares.append(share)
        visits.append(visited)
    return RegimeMap(bins=labels, share=np.array(shares), visited=np.array(visits))


def _places(data: ReportData, joint: int) -> dict[str, NDArray[np.intp]]:
    """The number of each held-out sample's bin; -1 where the quantity is not known."""
    some = data.held_out
    dq = np.concatenate([traces.dq[:, joint] for traces in some])
    q = np.concatenate([traces.q[:, joint] for traces in some])
    load = np.abs(np.concatenate([traces.load[:, joint] for traces in some]))
    age = np.concatenate([np.linspace(0, 1, len(traces.time)) for traces in some])
    turning = np.concatenate([_reversals(traces.time, traces.dq[:, joint]) for traces in some])
    speed = np.abs(dq)
    fast = _quantile(speed, 0.95)
    still = speed <= STILL * fast
    direction = np.where(turning, 1, np.where(dq > 0, 2, 0))
    direction[~np.isfinite(dq) | (still & ~turning)] = -1
    return {
        "speed": np.where(still, 0, 1 + _thirds(speed, ~still)),
        "direction": direction,
        "position": _thirds(q),
        "load": _thirds(load),
        "time": np.minimum((3 * age).astype(np.intp), 2),
    }


def _quantile(values: FloatArray, share: float) -> float:
    known = values[np.isfinite(values)]
    return float(np.quantile(known, share)) if known.size else 0.0


def _thirds(values: FloatArray, where: NDArray[np.bool_] | None = None) -> NDArray[np.intp]:
    """0, 1, 2 by equal thirds of the range that the bulk of the values covers."""
    among = values if where is None else values[where]
    low, high = _quantile(among, 0.01), _quantile(among, 0.99)
    if high <= low:
        return np.ones(len(values), dtype=np.intp)
    scaled = np.nan_to_num(3 * (values - low) / (high - low))
    return np.where(np.isfinite(values), np.clip(scaled.astype(np.intp), 0, 2), -1)


def _reversals(time: FloatArray, dq: FloatArray) -> NDArray[np.bool_]:
    """Whether a sample lies within REVERSAL of a change of direction."""
    speed = np.nan_to_num(dq)
    moving = np.flatnonzero(np.abs(speed) > STILL * _quantile(np.abs(speed), 0.95))
    turned = np.flatnonzero(np.diff(np.sign(speed[moving])) != 0)
    near = np.zeros(len(time), dtype=bool)
    period = float(np.median(np.diff(time))) if len(time) > 1 else 1.0
    reach = max(1, round(REVERSAL / period))
    for first, last in zip(moving[turned], moving[turned + 1], strict=True):
        near[first : min(first + reach, last)] = True  # a long rest between is no reversal
        near[max(first, last - reach) : last + reach + 1] = True
    return near
