"""What may be claimed: intervals, evidence on held-out recordings, the verdict.

Comes in: `Search`. Goes out: `Examination`, a `Diagnosis` with all it rests on. Next: evidence and
report.
"""
