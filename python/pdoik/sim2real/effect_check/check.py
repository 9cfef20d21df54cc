"""All checks of one effect."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from ..effects import Effect
from .against_simulation import COLUMNS, against_simulation
from .algebra import BOUNDS, NOTHING, THERE_AND_BACK, bounds, nothing, there_and_back
from .arm import Arm
from .found import found
from .gradients import GRADIENTS, STIFFNESS, gradients, stiffness
from .load import tried
from .outcome import Outcome
from .trial import Trial
from .words import UNITS, units_and_words

_LONGER = 24.0  # recordings that are diagnosed [s]
_CHECKS: dict[str, Callable[[Trial], Outcome]] = {
    COLUMNS: against_simulation,
    THERE_AND_BACK: there_and_back,
    BOUNDS: bounds,
    NOTHING: nothing,
    GRADIENTS: gradients,
    STIFFNESS: stiffness,
    UNITS: units_and_words,
}


def check_effect(
    effect: Effect, *, diagnose: bool = False, arm: Arm | None = None
) -> tuple[Outcome, ...]:
    """One outcome per check; a check that the effect makes raise has failed.

    Args:
        effect: in the catalogue or not.
        diagnose: whether to simulate recordings and diagnose them too, which takes longer.
        arm: to try it on; a new one if None.
    """
    example = effect.example
    if example is None:
        words = "it has no `example`: figures to try it with, such as Example(values={...})"
        return (Outcome(check="example", status="fail", words=words),)
    with TemporaryDirectory() as folder, tried([effect]):
        arm = arm or Arm(Path(folder))
        try:
            trial = Trial(effect, example, arm)
        except Exception as error:  # whatever an effect of somebody else's does
            return (_raised("example", error),)
        outcomes = []
        for name, check in _CHECKS.items():
            try:
                outcomes.append(check(trial))
            except Exception as error:
                outcomes.append(_raised(name, error))
        if diagnose:
            longer = Path(folder) / "longer"
            longer.mkdir()
            outcomes.append(found(trial, Arm(longer, _LONGER, example.held)))
    return tuple(outcomes)


def _raised(check: str, error: Exception) -> Outcome:
    words = f"it raises {type(error).__name__}: {error}"
    return Outcome(check=check, status="fail", words=words)
