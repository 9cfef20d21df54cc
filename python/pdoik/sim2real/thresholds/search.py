"""How large an effect must be to be seen: what a study can show, and the next motion should."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchThresholds(Group):
    """Of what `study check` and `propose` expect of a diagnosis."""

    least_t: float = threshold(
        3.5,
        "Wald statistic of a term beside the others, by clusters of rows",
        "s.e.",
        "once in 4000 by chance; some hundred candidates are tried",
    )
    least_size: float = threshold(0.5, "root mean square of a term where it acts", "sigma")
    least_share: float = threshold(
        0.002, "share of the mean square that the term's balances began with"
    )
    least_of_rest: float = threshold(
        0.12,
        "share of what is left that a term must explain; less is the misfit of another's law",
    )
    tie: float = threshold(0.03, "the same as a share of the gain, where blocks differ as much")
    tie_error: float = threshold(1.5, "errors by which blocks may differ in a tie", "s.e.")
    still_needed: float = threshold(
        0.7, "share of least_t and least_size that an accepted term must keep beside later ones"
    )
    better_set: float = threshold(
        4.0, "criterion by which a joint's other set of ordinary effects must be better"
    )
    same_kind: float = threshold(
        0.9, "share of a law's gain from which a coarser law of the same kind is listed beside it"
    )
    stands_t: float = threshold(
        3.0, "errors by which what is peculiar must stand beside all that may be ordinary", "s.e."
    )
    large: float = threshold(
        1.0 / 3.0, "share of what the background leaves on held-out rows that is no misfit of it"
    )
