"""A machine that is watched: rows of its logs in, alarms out, in constant memory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from pdoik.recordings import FloatArray, Recording

from ..model import Model
from ..thresholds import Thresholds
from .alarm import Alarm
from .calibrate import rows_of
from .causes import CauseSearch, Explanation
from .changes import Change, added
from .charts import Charts, Crossing
from .residuals import ResidualRows, Residuals, joined
from .windows import Rows, Window, Windows

_MOST = 4  # effects that a change is made of
_BEFORE = 1.0  # of the log that is kept before a window, so that onsets lie inside [s]


@dataclass(slots=True, kw_only=True)
class _Learning:
    """A change that was noticed and whose cause is being learnt, or learnt anew."""

    number: int
    crossing: Crossing
    onset: float  # [s]
    since: float  # when the charts began to rest [s]
    before: tuple[Change, ...]  # that were known when it was noticed
    joints: frozenset[str] = frozenset()  # at which it was found to act
    moved: float = 0.0  # time that the joint has moved since then [s]


class Watch:
    """Watches a machine by the model of its diagnosis.

    ::

        watch = Watch(model)
        for alarm in watch.feed(recording):
            print(alarm)

    What is fed may come in pieces of any size: the alarms are the same. After an alarm the charts
    rest while the cause is learnt; then the machine is watched as it is now, with what has changed.
    """

    def __init__(self, model: Model, *, thresholds: Thresholds | None = None) -> None:
        """Watch by a model that knows its healthy residuals, see `calibrated`.

        Raises:
            ValueError: the model has no robot, or knows nothing of the healthy machine, or its
                base floats.
        """
        every = Thresholds() if thresholds is None else thresholds
        limits = every.watch
        model = model.of_fixed_base
        if model.robot is None:
            raise ValueError("the study had no robot description, so no torque can be watched")
        if model.healthy is None:
            raise ValueError(
                "the model has no floor of healthy torques: its study had no held-out or fitted"
                " recording with 'tau' as the study has the robot; calibrate it with a log of the"
                " healthy machine"
            )
        self.model = model
        self.alarms = 0  # that were noticed so far
        self._limits = limits
        self._residuals = Residuals(model, model.healthy.position_noise, limits.slides)
        self._charts = Charts(model.healthy, limits)
        self._residuals.today = self._charts.today
        self._causes = CauseSearch(self._residuals, self._charts, every)
        self._windows = Windows(len(model.joints), self._residuals.cutoff)
        self._source = ""
        self._last = -np.inf
        self._kept: list[Window] = []  # of the last seconds, for the causes
        self._learning: _Learning | None = None
        self._past: _Learning | None = None

    @property
    def threshold(self) -> float:
        """Threshold of every chart: a log likelihood ratio."""
        return self._charts.threshold

    @property
    def unwatched(self) -> tuple[str, ...]:
        """Joints that moved too little in the healthy logs."""
        pairs = zip(self.model.joints, self._charts.watched, strict=True)
        return tuple(name for name, watched in pairs if not watched)

    def feed(
        self, log: Recording | Mapping[str, FloatArray], source: str | None = None
    ) -> list[Alarm]:
        """Watch more rows.

        Args:
            log: a recording, or columns of a piece of a log by their name: time, q.<joint>,
                tau.<joint>; (R,) each, in SI units. NaN where a value is missing.
            source: the log's name; another one than before begins a stream with a clock of its
                own. A recording has its own name.

        Returns:
            Alarms that these rows raise, in order.

        Raises:
            ValueError: a column is missing, the time runs backwards, there are too few rows a
                second.
        """
        rows = self._recorded(log) if isinstance(log, Recording) else self._given(log)
        name = source if source is not None else getattr(log, "name", self._source)
        alarms: list[Alarm] = []
        if name != self._source:
            alarms += self.end()
            self._source = name
        rows = self._rising(rows)
        for window in self._windows.add(rows):
            alarms += self._watch(window)
        return alarms

    def end(self) -> list[Alarm]:
        """Watch what is left of a stream that has ended; the next one has a clock of its own."""
        alarms = [alarm for window in self._windows.end() for alarm in self._watch(window)]
        if self._learning is not None:
            alarms.append(self._learnt())
        self._kept.clear()
        self._past = None
        self._last = -np.inf
        self._charts.cusum.since[:] = -np.inf
        self._charts.today.reset()
        return alarms

    def _recorded(self, recording: Recording) -> Rows:
        if recording.q.shape[1] != len(self.model.joints):
            raise ValueError(
                f"recording has {recording.q.shape[1]} joints, the model has"
                f" {len(self.model.joints)}"
            )
        return rows_of(recording)

    def _given(self, log: Mapping[str, FloatArray]) -> Rows:
        names = [f"{channel}.{j}" for channel in ("q", "tau") for j in self.model.joints]
        missing = [each for each in ("time", *names) if each not in log]
        if missing:
            raise ValueError(f"expected a column {missing[0]!r}; came {', '.join(log)}")
        values = np.stack([np.asarray(log[each], dtype=np.float64) for each in names], axis=1)
        time = np.asarray(log["time"], dtype=np.float64)
        there = np.isfinite(time) & np.isfinite(values).all(axis=1)
        n = len(self.model.joints)
        return Rows(time=time[there], q=values[there, :n], tau=values[there, n:])

    def _rising(self, rows: Rows) -> Rows:
        """Rows later than those before.

        Raises:
            ValueError: time runs backwards.
        """
        before = np.concatenate([[self._last], rows.time])[:-1]
        back = np.flatnonzero(rows.time < before)
        if len(back):
            k = int(back[0])
            raise ValueError(
                f"time runs backwards: {rows.time[k]:.6f} s after {before[k]:.6f} s; a log with a"
                " clock of its own is another source"
            )
        again = rows.time == before
        if len(rows):
            self._last = float(rows.time[-1])
        return Rows(time=rows.time[~again], q=rows.q[~again], tau=rows.tau[~again])

    def _watch(self, window: Window) -> Iterator[Alarm]:
        self._keep(window)
        rows = self._residuals.rows(window)
        while len(rows.time):
            if self._learning is not None:
                yield from self._learn(self._learning, rows)
                return
            used, crossing, _ = self._charts.update(rows)
            if crossing is None:
                return
            rows = rows[used:]
            if (past := self._same(crossing)) is not None:
                self._learning = replace(past, crossing=crossing, since=crossing.time, moved=0.0)
                continue
            self.alarms += 1
            self._learning = _Learning(
                number=self.alarms,
                crossing=crossing,
                onset=crossing.onset,
                since=crossing.time,
                before=self._residuals.changes,
            )
            explanation = self._explained(crossing.onset, 1)
            yield self._alarm(self._learning, "noticed", explanation)

    def _same(self, crossing: Crossing) -> _Learning | None:
        """The change that was learnt last, if this is what was learnt of it too badly."""
        past = self._past
        if past is None or crossing.time > past.onset + self._limits.revise:
            return None
        return past if self.model.joints[crossing.joint] in past.joints else None

    def _learn(self, learning: _Learning, rows: ResidualRows) -> Iterator[Alarm]:
        limits = self._limits
        learning.moved += rows.step * float(np.sum(rows.moving[:, learning.crossing.joint]))
        passed = float(rows.time[-1]) - learning.since
        if learning.moved >= limits.learn or passed >= limits.learn_at_most:
            yield self._learnt()

    def _learnt(self) -> Alarm:
        """Take the change into the model, and begin to watch again."""
        learning = self._learning
        assert learning is not None
        self._residuals.changes = learning.before
        explanation = self._explained(learning.onset, _MOST)
        self._residuals.changes = added(learning.before, explanation.changes)
        self._charts.cusum.reset()
        acts = {name for cause in explanation.causes for name in cause.joints}
        if any(cause.links for cause in explanation.causes):
            acts = set(self.model.joints)
        joint = self.model.joints[learning.crossing.joint]
        self._learning = None
        self._past = replace(
            learning, onset=explanation.onset, joints=frozenset({*acts, *learning.joints, joint})
        )
        return self._alarm(self._past, "learnt", explanation)

    def _keep(self, window: Window) -> None:
        """The last windows' rows, as many as an explanation may need."""
        self._kept.append(window)
        oldest = window.core[1] - self._limits.revise - 2.0 * self._windows.delay
        while self._kept[0].core[1] < oldest:
            self._kept.pop(0)

    def _explained(self, onset: float, most: int) -> Explanation:
        first = onset - _BEFORE - self._windows.delay
        windows = [each for each in self._kept if each.core[1] >= first]
        rows = windows[0].rows
        for each in windows[1:]:
            new = int(np.searchsorted(each.rows.time, rows.time[-1], side="right"))
            rows = rows.followed_by(each.rows[new:])
        motion, _ = self._residuals.motion_now(rows.recording())
        known = joined(self._residuals.rows(each) for each in windows)
        return self._causes.explain(motion, known, onset, most)

    def _alarm(self, learning: _Learning, stage: str, explanation: Explanation) -> Alarm:
        return Alarm(
            number=learning.number,
            stage=stage,
            joint=self.model.joints[learning.crossing.joint],
            onset=explanation.onset,
            told=float(self._kept[-1].rows.time[-1]),
            source=self._source,
            causes=explanation.causes,
            instead=explanation.instead,
        )
