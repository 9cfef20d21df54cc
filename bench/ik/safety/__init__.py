"""What a Tracker promises, measured; judged by Pinocchio, coal and NumPy, never by the library.

An experiment is a module with `SIZES` (quick, whole), `jobs`, `run_job` and `lines`: `steps`,
`carried`, `ball`, `cost`, `unreached`, `humanoid`, `follow`, `joints`. `world` says how far robots
are from what is around them, `least` how near to a goal they can come; `report` makes the table.
"""
