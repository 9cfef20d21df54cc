"""What was selected, confirmed: by simulations of the whole arm, and by sessions left out in turn.

Comes in: `Search`. Goes out: another, in which names that a regression confuses are distinguished
by simulation, and what does not hold where it was not learnt is no more accepted; and the terms
that are only suspected. Next: infer.
"""
