"""Millions of answers of random robots, each judged by code of its own.

`robots` and `scenes` draw what is asked; `solves` and `tracking` ask it and count; `kinematics`,
`hulls` and `judge` say what the answers are worth and share nothing with the solver; `cases` keeps
what failed; `report` makes the tables.
"""
