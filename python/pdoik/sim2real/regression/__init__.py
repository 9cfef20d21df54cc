"""Effects fitted to balances: least squares of many terms, cross-validated and bootstrapped.

Comes in: `Balances` and effects at places. Goes out: `Fit`s, `Trial`s of hypotheses, estimates with
intervals, and the findings that terms stand for.
"""
