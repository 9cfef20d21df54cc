"""White noise of channels: how much there is, and how much of it the controller acted on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray, Recording

from ..motion import derivative, thinned, zero_phase
from ..study import Controller
from ..thresholds import ChannelThresholds

ComplexArray = NDArray[np.complex128]

_LENGTH = 256  # samples of a segment
_LOW, _HIGH = 0.5, 0.95  # of Nyquist's frequency, where motion is over
_HIGH_THINNED = 0.7  # above, the filter before thinning has taken its part
_UNEVEN = 1e-3  # numerics: jitter over period from which rows were interpolated to the grid
_MOTION = 10.0  # [Hz], below which a robot moves
_LEAST_GAIN = 0.01
_QUIET = 0.25  # of the frequencies
_SHORTEST = 32  # numerics: samples of which a spectrum can be made
_OVERLAP = 1.3  # by which errors grow as segments overlap by half


@dataclass(frozen=True, slots=True, kw_only=True)
class Heard:
    """Share of a channel's noise that is found again in the controller's torque, per joint."""

    share: FloatArray  # (n,)
    error: FloatArray  # (n,), NaN where it is unknown


class ChannelNoise:
    """What is in the channels of some recordings above the frequencies of motion.

    Every segment of a recording is windowed and transformed; over the upper half of the spectrum
    the median of the squares gives the variance of white noise: an arm that hums has a line there.
    """

    def __init__(
        self,
        recordings: Sequence[Recording],
        controller: Controller | None,
        laws: Sequence[FloatArray | None],
        limits: ChannelThresholds,
    ) -> None:
        """Recordings are of one study, as they were read; laws are the controller's, thinned."""
        self.count = len(recordings)
        self._controller = controller
        self._laws = laws
        self._limits = limits
        self._thin = [thinned(r) for r in recordings]
        self._more = [t.period / r.period for t, r in zip(self._thin, recordings, strict=True)]
        self._uneven = any(r.jitter > _UNEVEN * r.raw_period for r in recordings)
        self._length = min(_LENGTH, *(len(t.time) for t in self._thin))
        frequency = np.arange(self._length // 2 + 1) / (0.5 * self._length)
        top = _HIGH_THINNED if max(self._more) > 1.0 else _HIGH
        self._band = (frequency >= _LOW) & (frequency <= top)
        self._fall = 1.0 - np.cos(np.pi * frequency[self._band])
        self._gain = self._gains()
        self._cache: dict[str, ComplexArray | None] = {}

    def spectra(self, channel: str) -> ComplexArray | None:
        """A channel's spectra, (segments, frequencies, n), each joint's in its usual unit.

        NaN for joints without it; None where no joint has it.
        """
        if channel not in self._cache:
            self._cache[channel] = self._spectra(channel)
        return self._cache[channel]

    def own(self, channel: str) -> ComplexArray | None:
        """`spectra`, of torques less what the controller's own noise explains of them."""
        torque = self.spectra(channel)
        if channel != "tau" or torque is None:
            return torque
        rest = torque.copy()
        found = [self.spectra(name) for name in ("tau_cmd", "q", "dq")]
        causes = [spectra for spectra in found if spectra is not None]
        for j in range(torque.shape[2]):
            known = [c[..., j] for c in causes if np.isfinite(c[..., j]).all()]
            if known and np.isfinite(torque[..., j]).all():
                beta, _ = _least_squares(torque[..., j], known)
                rest[..., j] -= sum(b * c for b, c in zip(beta, known, strict=True))
        return rest

    def levels(self, channel: str) -> FloatArray | None:
        """Variance of white noise in every segment, (segments, n); None without the channel.

        Rows at uneven times were interpolated to a grid, which lowers the noise by
        1 - b (1 - cos(w)), the same for every joint: b is found from the spectra of all.
        """
        spectra = self.own(channel)
        if spectra is None or self._length < _SHORTEST:
            return None
        power = np.abs(spectra) ** 2
        level = np.median(power, axis=1) / np.log(2.0)  # squares are distributed exponentially
        if self._uneven and channel != "q":
            middle = np.median(level, axis=0)
            some = middle > 0.0  # NaN is not
            if some.any():
                usual = np.median((power[..., some] / middle[some]).mean(axis=0), axis=1)  # (F,)
                columns = np.stack([np.ones_like(self._fall), self._fall], axis=1)
                true = float(np.linalg.lstsq(columns, usual, rcond=None)[0][0])
                level *= np.clip(true, 1.0, 1.0 / np.mean(1.0 - 0.5 * self._fall))
        return np.asarray(level * np.mean(self._more), dtype=np.float64)

    def white(self, channel: str) -> FloatArray:
        """Share of what `levels` is of that is white, (n,): as strong in most of the spectrum.

        What an arm hums or a controller rings with is in parts of it.
        """
        spectra = self.own(channel)
        assert spectra is not None
        usual = np.mean(np.abs(spectra) ** 2, axis=0)  # (F, n)
        quiet = np.quantile(usual, _QUIET, axis=0)
        return np.asarray(quiet / np.maximum(np.mean(usual, axis=0), 1e-300), dtype=np.float64)

    def heard(self, channel: str) -> Heard | None:
        """How much of the noise in q or dq the controller turned into torque.

        What is in the file but not in the command was added after the controller had read the
        sensor. Without a command it is looked for in the drives' torque, of which a file keeps a
        few ticks' mean: then all sound joints have the same share, but not one.
        """
        control = self._controller
        answer = next((n for n in ("tau_cmd", "tau") if self.spectra(n) is not None), None)
        if control is None or answer is None or self.spectra(channel) is None:
            return None
        torque = self.spectra(answer)
        assert torque is not None
        read = {"q": control.kp, "dq": control.kd}
        names = [name for name in read if self.spectra(name) is not None]
        n = torque.shape[2]
        share, error = np.full((2, n), np.nan)
        gain = self._followed() if answer == "tau" else np.ones(n)
        for j in range(n):
            columns = [-read[name][j] * _of(self.spectra(name), j) for name in names]
            finite = all(np.isfinite(c).all() and np.any(c) for c in (*columns, torque[..., j]))
            if finite and np.isfinite(gain[j]):
                beta, std = _least_squares(torque[..., j], columns)
                k = names.index(channel)
                share[j], error[j] = beta[k] / gain[j], std[k] / abs(gain[j])
        return Heard(share=share, error=error)

    def size(self, channel: str) -> FloatArray:
        """What a channel usually comes to: its 0.9 quantile about its median, (n,)."""
        values = np.vstack([getattr(t, channel) for t in self._thin])
        about = 0.0 if channel == "tau" else np.median(values, axis=0)
        return np.asarray(np.quantile(np.abs(values - about), 0.9, axis=0), dtype=np.float64)

    def _spectra(self, channel: str) -> ComplexArray | None:
        if any(getattr(t, channel) is None for t in self._thin):
            return None
        window = np.hanning(self._length)
        gain = self._gain.get(channel, 1.0)
        parts = []
        for t in self._thin:
            values = getattr(t, channel) / gain
            for start in range(0, len(values) - self._length + 1, max(1, self._length // 2)):
                part = values[start : start + self._length]
                part = (part - part.mean(axis=0)) * window[:, None]
                parts.append(np.fft.rfft(part, axis=0)[self._band])
        return np.asarray(np.stack(parts) / np.sqrt(np.sum(window**2)))

    def _gains(self) -> dict[str, FloatArray]:
        """How many times what they should be positions and speeds are: a scale is no noise."""
        gains: dict[str, FloatArray] = {}
        asked = [_about_mean(t.q_des) for t in self._thin if t.q_des is not None]
        speeds = [t.dq for t in self._thin if t.dq is not None]
        if len(asked) == self.count:
            came = [_about_mean(t.q) for t in self._thin]
            gains["q"] = _slope(np.vstack(came), np.vstack(asked), self._limits.smallest)
        if len(speeds) == self.count:
            rates = [derivative(zero_phase(t.q, _MOTION, t.period), t.period) for t in self._thin]
            rate = np.vstack(rates) / gains.get("q", 1.0)
            gains["dq"] = _slope(np.vstack(speeds), rate, self._limits.slowest)
        return gains

    def _followed(self) -> FloatArray:
        """Each joint's torque over the controller's law; NaN where it comes later than others'."""
        n = self._thin[0].q.shape[1]
        gain, late, unsure = np.full((3, n), np.nan)
        filtered = np.sqrt(max(0.5 / (_MOTION * self._thin[0].period), 1.0))
        for j in range(n):
            rows = []
            for t, law in zip(self._thin, self._laws, strict=True):
                if t.tau is None or law is None:
                    return gain
                smooth = zero_phase(np.stack([t.tau[:, j], law[:, j]], 1), _MOTION, t.period)
                rate = -derivative(smooth[:, 1], t.period)
                rows.append(np.column_stack([smooth, rate, np.ones(len(rate))]))
            table = np.vstack(rows)
            if not np.isfinite(table).all() or not np.any(table[:, 1]):
                continue
            inverse = np.linalg.pinv(table[:, 1:].T @ table[:, 1:])
            beta = inverse @ (table[:, 1:].T @ table[:, 0])
            left = float(np.std(table[:, 0] - table[:, 1:] @ beta))
            if beta[0] == 0.0:
                continue
            gain[j], late[j] = beta[0], beta[1] / beta[0]
            unsure[j] = filtered * left * np.sqrt(inverse[1, 1]) / abs(beta[0])
        if np.isnan(late).all():
            return gain
        after = np.abs(late - np.nanmedian(late)) + 2.0 * unsure
        in_time = after < self._limits.late * self._thin[0].period
        sound = in_time & (np.abs(np.log(np.abs(gain))) < np.log(self._limits.drive_gain))
        return np.where(sound, gain, np.nan)


def _least_squares(
    target: ComplexArray, columns: list[ComplexArray]
) -> tuple[FloatArray, FloatArray]:
    """Real factors of columns, (segments, frequencies), and their errors over the segments."""
    A = np.stack([_real(c) for c in columns], axis=2)  # (S, 2F, k)
    y = _real(target)
    inverse = np.linalg.pinv(np.einsum("sfk,sfl->kl", A, A))
    beta = inverse @ np.einsum("sfk,sf->k", A, y)
    scores = np.einsum("sfk,sf->sk", A, y - A @ beta)
    spread = np.sqrt(np.diag(inverse @ (scores.T @ scores) @ inverse))
    return beta, _OVERLAP * spread


def _real(values: ComplexArray) -> FloatArray:
    return np.concatenate([values.real, values.imag], axis=1)


def _about_mean(values: FloatArray) -> FloatArray:
    return np.asarray(values - values.mean(axis=0), dtype=np.float64)


def _slope(values: FloatArray, of: FloatArray, least: float) -> FloatArray:
    """Factor between columns, 1 where the second hardly varies, never below a hundredth."""
    slope = np.sum(of * values, axis=0) / np.maximum(np.sum(of**2, axis=0), 1e-12)
    moved = np.std(of, axis=0) > least
    return np.where(moved & np.isfinite(slope), np.maximum(np.abs(slope), _LEAST_GAIN), 1.0)


def _of(spectra: ComplexArray | None, j: int) -> ComplexArray:
    assert spectra is not None
    return np.asarray(spectra[..., j])
