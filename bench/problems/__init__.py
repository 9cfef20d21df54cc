"""Scenes as users have them: public problem sets and our own of the same kinds, judged by meshes.

Problems come in from files (`loaders`) or are made (`families`), a method answers them within a
budget (`methods`), and coal says on the robot's published meshes and the true shapes whether an
answer touches anything (`judge`). `python -m bench.problems --help` has the commands.
"""

import sys
from pathlib import Path

_BESIDE = str(Path(__file__).resolve().parent.parent)
if _BESIDE not in sys.path:  # tables and provenance stand beside it, by plain names
    sys.path.append(_BESIDE)
