"""Robots with a floating base that have something concealed: study folders, truths elsewhere.

A quadruped and a humanoid in plain MuJoCo trot, stand and hang; their joints, bodies, IMU and
ground differ from what the study says. Nothing of the worlds imports `pdoik`: they and the
diagnosis share no code. Run from the repository's root:

    python -m bench.sim2real.generate legged --robot go2 --kind payload --out DIR
"""
