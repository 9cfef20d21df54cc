"""What all benches on machines share: arms as figures, files of a study, sealed runs, scores.

A generator of worlds (`concealed`, `machines`, `legged`, pairs of `simulators`) draws a spec, moves
its own physics and writes a study here and its truth elsewhere. `SealedRun` makes and seals the
worlds, diagnoses each in a process that sees its study only, and opens the truths to score.
Generators import this package and never one another's physics.
"""
