"""When a torque without a name is claimed."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class UnnamedThresholds(Group):
    """Of functions that stand for what no named effect explains."""

    least_left: float = threshold(
        1.35, "root mean square below which nothing is left to explain", "sigma"
    )
    least_share: float = threshold(
        0.08, "share of the mean square residual the joint began with that it must explain"
    )
    names_explain: float = threshold(
        0.96, "share of what the unnamed function does, below which the names are not right"
    )
    far: float = threshold(
        2.2, "what names leave, from which a function is worth having that ends it", "sigma"
    )
    near: float = threshold(1.5, "what that function may leave", "sigma")
    simple: float = threshold(
        0.85, "share of the best gain from which a function of few coefficients is preferred"
    )
    alone: float = threshold(
        1.3, "times what is left with names too, which the function may leave without them"
    )
    alone_share: float = threshold(
        0.002, "share of what the joint began with that it may leave beyond that"
    )
