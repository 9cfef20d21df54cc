"""Worlds with something concealed: study folders whose truth the diagnosis never sees.

MuJoCo arms with their own friction laws, controller and sensors write recordings that look like
a real machine's; what was hidden, and how, goes to a truth file in another folder. Nothing here
imports `pdoik.sim2real`: the worlds and the diagnosis share no code.

    python -m bench.sim2real.generate concealed --out DIR --seed 0 --count 20
"""
