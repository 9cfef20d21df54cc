"""A sensor that is noisier than it should be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pdoik.recordings import FloatArray, Recording

from ...motion import Columns, Motion, Place, Shape
from ..effect import Effect, Example, Parameter


class SensorNoise(Effect):
    """logged = true + white noise: estimated from spectra, before anything is fitted."""

    id = "sensor_noise"
    family = "sensor"
    on = "channel"
    size_first = True
    equation = "logged = true + n, n white"
    parameters = (Parameter("std", "unit of the channel", lower=0.0),)
    decided_by = "the robot at rest, brakes on"
    source = "white noise above the frequencies of motion"
    example = Example(values={"std": 0.5}, place=Place(joints=(1,)))
    sought = "channels"

    def places(self, motions: Sequence[Motion]) -> list[Place]:
        """None: it is no part of a balance."""
        return []

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """None."""
        return {}

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """Standard deviation of the noise."""
        return {"std": float(beta[0])}

    def logged(self, recording: Recording, place: Place, values: Mapping[str, float]) -> Recording:
        """Recording with noise added to the torques."""
        if recording.tau is None:
            return recording
        tau = recording.tau.copy()
        noise = np.random.default_rng(0).standard_normal((len(tau), len(place.joints)))
        tau[:, list(place.joints)] += values["std"] * noise
        return replace(recording, tau=tau)

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return f"A sensor of {where} has white noise of {values['std']:.2g}."
