"""What was identified, held against simulations of the whole arm.

Comes in: `Identified`. Goes out: another, in which names that a regression confuses are told apart
by rollouts, and figures are moved to where rollouts leave least. Next: infer.
"""
