"""What is given: a study's keys, its recordings with their units and gaps, facts of the robot.

Comes in: study.yaml and the files it names. Goes out: a `Study` of `Recording`s on even times, in
SI units, parted into those to fit and those held out, with a `Setup` for each that was made
otherwise (attached body, gains, the day); or a `LoadError` that says what was expected.
Next: motion.
"""

from .controller import GAINS, Controller, GivenController, VoltageDrive
from .controller_key import given_controller
from .excerpts import ROWS, excerpted, highest_cutoff
from .floating_base import FloatingBase, Foot, Ground
from .key_tables import reference
from .keys import read_part, trust_from
from .payload import Payload
from .read_study import load_study
from .reading_key import reading_of_study
from .split import part, split
from .study import Setup, Study, Trust

__all__ = [
    "GAINS",
    "ROWS",
    "Controller",
    "FloatingBase",
    "Foot",
    "GivenController",
    "Ground",
    "Payload",
    "Setup",
    "Study",
    "Trust",
    "VoltageDrive",
    "excerpted",
    "given_controller",
    "highest_cutoff",
    "load_study",
    "part",
    "read_part",
    "reading_of_study",
    "reference",
    "split",
    "trust_from",
]
