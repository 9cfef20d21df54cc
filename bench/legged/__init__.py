"""Robots with a floating base that have something concealed: study folders, truths elsewhere.

A quadruped and a humanoid in plain MuJoCo trot, stand and hang; their joints, bodies, IMU and
ground differ from what the study says. Nothing of the worlds imports `pdoik`: they and the
diagnosis share no code. Run from the repository's root:

    python -m bench.legged make --robot go2 --kind payload --background plain --seed 1 --out DIR
"""

import sys
from pathlib import Path

_BESIDE = str(Path(__file__).resolve().parent.parent)
if _BESIDE not in sys.path:  # campaign, whole_files and others call one another by plain names
    sys.path.append(_BESIDE)
