"""When a torque is taken to be cut off."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitThresholds(Group):
    """Thresholds of a level, or a line falling with speed, beyond which no torque is given."""

    flat: float = threshold(0.02, "share of the level within which a top is flat despite all noise")
    flatter: float = threshold(0.3, "spread of a top over that of what is asked for beyond it")
    flatter_once: float = threshold(0.1, "the same where it was reached on one occasion only")
    noise: float = threshold(4.0, "what counts as beyond a level, over the noise", "sigma")
    least_rows: int = threshold(6, "samples at a level, their neighbours beyond it too", "rows")
    least_rows_once: int = threshold(15, "the same where it was reached on one occasion", "rows")
    apart: float = threshold(0.2, "time between two occasions", "s")
    missing: float = threshold(
        0.02, "share of the highest torque by which less is given than asked for, of a line"
    )
    least_rows_of_line: int = threshold(30, "samples on a line", "rows")
    least_span: float = threshold(0.01, "range of speeds that a line covers", "rad/s")
    on_line: float = threshold(
        0.02, "share of the stall torque within which a top is straight despite all noise"
    )
    kept: float = threshold(
        0.8, "share of the samples short of what is asked for that must lie on a line"
    )
    falls: float = threshold(0.08, "share of the stall torque that a line falls by")
    falls_clearly: float = threshold(3.0, "fall of a line over its spread")
    fastest: float = threshold(
        50.0, "no-load speed over the highest speed seen, beyond which a line does not fall"
    )
    least_piled: int = threshold(20, "samples at a ceiling that is seen in torques alone", "rows")
    least_share: float = threshold(0.02, "the same as a share of all samples")
    least_occasions: int = threshold(3, "occasions on which it must be reached", "occasions")
    piled: float = threshold(2.0, "samples at such a ceiling over those just below it, per N m")
    over: float = threshold(0.1, "samples beyond a level, line or ceiling, over those at it")
    varies: float = threshold(
        0.7, "spread of gravity or inertia at a ceiling over the width that its noise makes likely"
    )
    above_noise: float = threshold(8.0, "least level of a ceiling over that width")
