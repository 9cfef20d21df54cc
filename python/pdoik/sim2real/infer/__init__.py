"""What may be claimed: figures, intervals, confidence; then the judgement of held-out recordings.

Comes in: `Identified`. Goes out: `Examination`, a `Diagnosis` with all it rests on. Recordings held
out come in here, last, and change no finding. Next: evidence and report.
"""
