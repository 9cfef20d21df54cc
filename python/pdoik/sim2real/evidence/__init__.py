"""What a report shows of an examination, and the files that go with it.

Comes in: `Examination`. Goes out: `ReportData`, diagnosis.json, model.json, the improved model and
the report.
"""

from .files import DIAGNOSIS, write, write_files
from .gather import evidence_of, model_of
from .motions import FILE_NAME, Motion, Motions
from .replays import replay_of, replays_of
from .servo_model import servo_model, with_drive

__all__ = [
    "DIAGNOSIS",
    "FILE_NAME",
    "Motion",
    "Motions",
    "evidence_of",
    "model_of",
    "replay_of",
    "replays_of",
    "servo_model",
    "with_drive",
    "write",
    "write_files",
]
