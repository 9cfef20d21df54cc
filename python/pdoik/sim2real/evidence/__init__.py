"""What a report shows of an examination, and the files that go with it.

Comes in: `Examination`. Goes out: `ReportData`, diagnosis.json, model.json, the improved model and
the report.
"""

from .files import write
from .gather import evidence_of, model_of
from .servo_model import servo_model

__all__ = ["evidence_of", "model_of", "servo_model", "write"]
