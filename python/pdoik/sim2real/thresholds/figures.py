"""How sure figures are, and which of them are nothing after all."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class FigureThresholds(Group):
    """Of values, their errors, and what sampling leaves open of them."""

    least_t: float = threshold(
        2.0, "errors below which the size of what was found may as well be zero", "s.e."
    )
    on_bound: float = threshold(1e-3, "share of a bound within which a figure lies on it")
    discretisation: float = threshold(
        0.0015, "share of a value that differentiation and sampling may take"
    )
    torque_scale: float = threshold(
        0.04,
        "standard deviation of a torque's own scale, which intervals of all that follows from"
        " torques include; 'trust: {torque: ...}' of a study says another",
        "",
        "gain errors of current sensors and torque constants: data sheets, 3 to 5 %",
    )
    spread_p: float = threshold(
        0.01, "probability of differences between sessions, below which they are said"
    )
    usual_spread: float = threshold(
        0.5,
        "share of friction by which sessions may differ and be of one cause",
        "",
        "chosen: from day to day it changes by 10 to 30 %",
    )
    silent: float = threshold(
        10.0, "times the variance before any row, from which a session says nothing of a figure"
    )
    least_clusters: int = threshold(
        12, "clusters of rows in which a term acts, from which its error is estimated", "clusters"
    )
    shortest_cluster: float = threshold(0.25, "length below which clusters are not parted", "s")
    position_delay: float = threshold(
        0.03,
        "standard deviation of a position's delay by sampling, in periods",
        "",
        "forty studies with nothing wrong: 0.013 root mean square, 0.06 at most",
    )
    torque_delay: float = threshold(
        0.15,
        "the same of a torque's",
        "",
        "twice the 0.08 of such studies: machines differ in when within a tick a torque acts",
    )
    unknown_delay: float = threshold(0.3, "the same of any where the period is not known")
    log_delay: float = threshold(0.01, "part of the same by interpolation, in the log's periods")
    delay_t: float = threshold(
        3.0, "standard deviations of sampling by which a delay is above a period", "s.e."
    )
    delay_told: float = threshold(
        1 / 3, "share of a delay, below which another joint's error says whether it is late too"
    )
    delay_shared: float = threshold(
        0.5, "share of a delay that other joints must show for it to be all joints'"
    )
