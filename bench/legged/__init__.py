"""Robots with a floating base that have something concealed: study folders, truths elsewhere.

A quadruped and a humanoid in plain MuJoCo trot, stand and hang; their joints, bodies, IMU and
ground differ from what the study says. Nothing here imports `pdoik`'s simulation: the worlds and
the diagnosis share no code.

    python -m bench.legged make --robot go2 --kind payload --background plain --seed 1 --out DIR
"""
