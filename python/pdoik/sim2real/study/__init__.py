"""What is given: a study's keys, its recordings with their units and gaps, facts of the robot.

Comes in: study.yaml and the files it names. Goes out: a `Study` of `Recording`s on even times, in
SI units, parted into those to fit and those held out, with a `Setup` for each that was made
otherwise (what it held, gains, the day); or a `LoadError` that says what was expected.
Next: motion.
"""
