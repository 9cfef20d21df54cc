"""A first study.yaml from a robot and logs: `pdoik study new` in Python.

Comes in: a robot's description and recordings. Goes out: `Draft`, the commented text of a study
that loads, what was guessed in it, and questions about what could not be.
"""

from .draft import Draft, draft_study

__all__ = ["Draft", "draft_study"]
