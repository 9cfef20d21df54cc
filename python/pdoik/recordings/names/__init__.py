"""What the columns of a log mean: channel, joint and unit, from their names or from `columns:`.

Comes in: columns as a log names them. Goes out: which of them is `q.elbow`, which is the time, and
in what units, or a `LoadError` that asks for `columns:`. What a name says is found in `words`;
whose it is, by the joints' names or by their order. Next: check_recording.
"""

from .check_names import check_names
from .columns_key import ColumnsKey, columns_key
from .known import ALONG_THE_ARM, Known, Settled, listed
from .mujoco_order import mujoco_order
from .settle import BEYOND_SECONDS, naming_notes, settle

__all__ = [
    "ALONG_THE_ARM",
    "BEYOND_SECONDS",
    "ColumnsKey",
    "Known",
    "Settled",
    "check_names",
    "columns_key",
    "listed",
    "mujoco_order",
    "naming_notes",
    "settle",
]
