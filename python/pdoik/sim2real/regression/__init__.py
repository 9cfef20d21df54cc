"""Effects fitted to balances: least squares of many terms, cross-validated.

Comes in: `Balances` and effects at places. Goes out: `Fit`s, what they say of other recordings, and
the findings that terms stand for.
"""
