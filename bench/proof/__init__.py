"""The proof: worlds concealed, sealed, diagnosed blind, and only then scored.

    python -m bench.proof --out DIR

Run from the repository's root. `bench.concealed` makes the worlds and knows nothing of the
diagnosis; the diagnosis runs in processes that know nothing of either. Here alone both meet.
"""

import sys
from pathlib import Path

_BESIDE = str(Path(__file__).resolve().parent.parent)
if _BESIDE not in sys.path:  # campaign, intervals and the others call one another by plain names
    sys.path.append(_BESIDE)
