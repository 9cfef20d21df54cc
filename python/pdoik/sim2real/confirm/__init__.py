"""What was selected, held against simulations of the whole arm from its commands.

Comes in: `Search`. Goes out: the same with names that a regression confuses told apart, and figures
moved to where simulation and recordings agree. Next: infer.
"""
