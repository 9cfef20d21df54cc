"""One posterior over sets of causes: balances come in, causes with figures and odds go out.

Read in this order: `hypothesis` (what is believed beforehand), `linearisation` (rows and sums),
`model` (a set of hypotheses, its noise and evidence), `ordinary` (what every machine has), `pool`
and `proposals` (candidates), `posterior` (the moves), `identify` (what is claimed), `figures`.
What was identified is confirmed by simulation in `confirm` and reported by `infer`.
"""

from .candidates import candidates
from .confidence import confidence_of, features
from .contacts import Window, acting, clearest, contact_term, pauses, stands
from .figures import estimates, event_estimates, values_and_errors
from .flexible import count_independent
from .hypothesis import Hypothesis, anomalous, ordinary
from .identified import Identified, Part, Weighed
from .identify import identify, relinearised
from .linearisation import Linearisation, Series
from .model import Model
from .ordinary import OF_JOINTS, Ordinary, changes_of
from .pool import Pool, Scored
from .posterior import Posterior
from .predicted import Expected, Noise, Remainder, all_else, expected, recorded, remainder
from .support import as_trusted, held_out_support
from .weighing import State, fits_with, serious

__all__ = [
    "OF_JOINTS",
    "Expected",
    "Hypothesis",
    "Identified",
    "Linearisation",
    "Model",
    "Noise",
    "Ordinary",
    "Part",
    "Pool",
    "Posterior",
    "Remainder",
    "Scored",
    "Series",
    "State",
    "Weighed",
    "Window",
    "acting",
    "all_else",
    "anomalous",
    "as_trusted",
    "candidates",
    "changes_of",
    "clearest",
    "confidence_of",
    "contact_term",
    "count_independent",
    "estimates",
    "event_estimates",
    "expected",
    "features",
    "fits_with",
    "held_out_support",
    "identify",
    "ordinary",
    "pauses",
    "recorded",
    "relinearised",
    "remainder",
    "serious",
    "stands",
    "values_and_errors",
]
