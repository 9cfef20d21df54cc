"""`pdoik view`: a robot in the browser whose target, obstacles and joints can be dragged.

The parts that need no browser are here; `pdoik.view.server` needs viser (`pip install
'pdoik[view]'`).
"""

from .log import Log, load_log
from .obstacles import Obstacles
from .session import Session
from .shown import Shown
from .worker import Worker

__all__ = ["Log", "Obstacles", "Session", "Shown", "Worker", "load_log"]
