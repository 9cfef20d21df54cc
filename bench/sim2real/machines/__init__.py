"""Machines as they stand in workshops, simulated, with one fault on top or none.

Made from what datasheets and the literature say of drives, gears, bearings and sensors, not from
the diagnosis's catalogue; integrated with a variable step by code of its own. What comes in is a
seed, what goes out a study folder and, elsewhere, its truth.
"""
