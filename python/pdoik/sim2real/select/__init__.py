"""Which effects, where: hypotheses accepted by what they gain on rows their fit did not see.

Comes in: `Balances`. Goes out: `Search`, with the terms accepted, their rivals and all that was
tried. Next: confirm.
"""
