"""What a term must bring to be accepted by the search."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchThresholds(Group):
    """Of hypotheses, held against rows that their coefficients were not fitted to."""

    least_training_gain: float = threshold(
        20.0, "decrease of the cost below which a candidate is not looked at", "sigma^2"
    )
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
    few_rows: int = threshold(40, "rows below which a term acts in few", "rows")
    least_in_few: float = threshold(80.0, "gain of what acts in few rows", "sigma^2")
    least_relief: float = threshold(
        12.0,
        "decrease of the prior's penalty from which the prior asks for a term",
        "sigma^2",
        "a log evidence of six",
    )
    tie_size: float = threshold(
        0.2, "root mean square by which a candidate may be worse than one it is level with", "sigma"
    )
    tie: float = threshold(0.03, "the same as a share of the gain, where blocks differ as much")
    tie_error: float = threshold(1.5, "errors by which blocks may differ in a tie", "s.e.")
    fixed_from: float = threshold(
        0.6, "lowest coefficient, set free, of a term whose coefficient is 1 by its meaning"
    )
    fixed_to: float = threshold(1.6, "highest of the same")
    least_inside: float = threshold(
        0.02, "share of a term's squared column on the rows that count; less is a filter's ringing"
    )
    still_needed: float = threshold(
        0.7, "share of least_t and least_size that an accepted term must keep beside later ones"
    )
    better_set: float = threshold(
        4.0, "criterion by which a joint's other set of ordinary effects must be better"
    )
    screened: int = threshold(12, "candidates of the highest training gain that are tried a round")
    hopeless: int = threshold(60, "trials without a significant one after which a round gives up")
    most_terms: int = threshold(40, "terms at most")
    same_kind: float = threshold(
        0.9, "share of a law's gain from which a coarser law of the same kind is listed beside it"
    )
    no_finer: float = threshold(
        0.99, "the same share from which the coarser law is the name: what is finer says too little"
    )
