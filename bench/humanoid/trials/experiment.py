"""The whole experiment: which trials there are, and their results as they come."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np

from bench.common.whole_files import write_whole
from bench.humanoid.dodge.follow import Steps
from bench.humanoid.dodge.plan import Planner
from bench.humanoid.trials.draw_throws import draw_throws
from bench.humanoid.trials.predict import Budget, predict
from bench.humanoid.trials.react import SPEEDS, react
from bench.humanoid.trials.stand import stand
from bench.humanoid.trials.store import Record, Store
from bench.humanoid.world.log import write_log
from bench.humanoid.world.objects import OBJECT_NAMES, FlyingObject, load_object
from bench.humanoid.world.robot import PAPER, SETUPS, Setup
from bench.humanoid.world.throws import Throw

MODES = ("stand", "predict", "react")
REACT_LOG_EVERY = 10  # slow throws last long: a hundred rows a second


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """What is run."""

    modes: tuple[str, ...] = MODES
    setups: tuple[str, ...] = tuple(SETUPS)
    throws: int = 20
    seed: int = 0
    ycb: Path | None = None  # None: primitives
    budget: Budget = field(default_factory=Budget)
    react_speeds: tuple[float, ...] = SPEEDS  # [m/s]
    stand_seconds: float = 10.0
    push_seconds: float = 3.0

    @property
    def identity(self) -> Record:
        """What two results in one folder must share; the rest only says how many there are."""
        return {
            "seed": self.seed,
            "objects": "primitives" if self.ycb is None else "YCB",
            "budget": asdict(self.budget),
            "stand_seconds": self.stand_seconds,
            "push_seconds": self.push_seconds,
        }


QUICK = Settings(
    throws=3,
    budget=Budget(seconds=0.4, long_seconds=0.4, long_plans=2, after=0.2),
    react_speeds=(2.0,),
    stand_seconds=0.3,
    push_seconds=0.4,
)

# The paper does not give its path. On a ball the right foot takes no moment, so that one ankle's 40
# N m hold the robot: these are slow and high enough to be dodged with that.
PAPER_SPEED = 1.5  # [m/s]
PAPER_THROWS: tuple[Throw, ...] = tuple(
    Throw(
        object_name=name,
        aim=aim,
        start=(start_x, -2.4, aim[2] + 0.3),
        speed=PAPER_SPEED,
        arc=0.25,
        tumble=(2.0, 1.0, 0.0),
    )
    for name, aim, start_x in (
        (OBJECT_NAMES[0], (0.05, 0.0, 1.3), 0.5),
        (OBJECT_NAMES[1], (0.0, 0.0, 1.4), 0.0),
        (OBJECT_NAMES[2], (-0.2, -0.02, 1.2), -0.6),
    )
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """One trial to run."""

    mode: str
    setup: Setup
    index: int = 0  # of the throw
    speed: float | None = None  # [m/s], for react

    @property
    def name(self) -> str:
        """Name of its files."""
        if self.mode == "stand":
            return f"stand_{self.setup.name}"
        end = "" if self.speed is None else f"_{self.speed:g}"
        return f"{self.mode}_{self.setup.name}_{self.index:03d}{end}"


class Experiment:
    """Trials of some settings, kept in a folder."""

    def __init__(self, settings: Settings, folder: Path) -> None:
        self.settings = settings
        self.things: dict[str, FlyingObject] = {
            name: load_object(name, settings.ycb) for name in OBJECT_NAMES
        }
        self.store = Store(folder, settings.identity)
        self.logs = folder / "logs"
        self.steps = folder / "steps"
        self.logs.mkdir(exist_ok=True)
        self.steps.mkdir(exist_ok=True)
        self._planners: dict[str, Planner] = {}
        self._throws: dict[str, list[Throw]] = {}

    def jobs(self) -> list[Job]:
        """All of them, done or not."""
        return [job for mode in self.settings.modes for job in self._jobs(mode)]

    def _jobs(self, mode: str) -> Iterator[Job]:
        for name in self.settings.setups:
            setup = SETUPS[name]
            if mode == "stand":
                yield Job(mode=mode, setup=setup)
                continue
            n = self.n_throws(setup)
            speeds = self.settings.react_speeds if mode == "react" else (None,)
            yield from (
                Job(mode=mode, setup=setup, index=k, speed=speed)
                for speed in speeds
                for k in range(n)
            )

    def n_throws(self, setup: Setup) -> int:
        """The paper's set-up has the paper's throws, the others the random ones."""
        return len(PAPER_THROWS) if setup == PAPER else self.settings.throws

    def throws(self, setup: Setup) -> list[Throw]:
        """What flies in a set-up. All but `paper` stand alike and share their throws."""
        if setup == PAPER:
            return list(PAPER_THROWS)
        if setup.name not in self._throws:
            hits, _ = draw_throws(self.things, setup, self.settings.throws, self.settings.seed)
            self._throws[setup.name] = [hit.throw for hit in hits]
        return self._throws[setup.name]

    def planner(self, setup: Setup) -> Planner:
        """One for each set-up."""
        if setup.name not in self._planners:
            self._planners[setup.name] = Planner(setup)
        return self._planners[setup.name]

    def run(self, job: Job) -> Record:
        """The result of a trial, from the folder if it is there."""
        done = self.store.get(job.name)
        if done is not None:
            return done
        record = getattr(self, f"_{job.mode}")(job)
        return self.store.put(job.name, record)

    def _stand(self, job: Job) -> Record:
        record, run = stand(job.setup, self.settings.stand_seconds, self.settings.push_seconds)
        write_log(run, self.logs / f"{job.name}.csv")
        return record

    def _predict(self, job: Job) -> Record:
        throw = self.throws(job.setup)[job.index]
        record, trial = predict(
            job.setup,
            self.things[throw.object_name],
            throw,
            self.planner(job.setup),
            self.settings.budget,
            self.settings.seed + job.index,
        )
        if trial is not None:
            write_log(trial.run, self.logs / f"{job.name}.csv")
            self._keep_steps(job, trial.steps)
        return record

    def _react(self, job: Job) -> Record:
        assert job.speed is not None
        throw = self.throws(job.setup)[job.index].at_speed(job.speed)
        record, run, steps = react(
            job.setup, self.things[throw.object_name], throw, self.settings.budget.after
        )
        write_log(run, self.logs / f"{job.name}.csv", REACT_LOG_EVERY)
        self._keep_steps(job, steps)
        return record

    def _keep_steps(self, job: Job, steps: Steps) -> None:
        columns = {"time": steps.time, "seconds": steps.column("time")}
        small = {name: column.astype(np.float32) for name, column in columns.items()}
        write_whole(self.steps / f"{job.name}.npz", lambda file: np.savez_compressed(file, **small))


def settings_for(
    quick: bool,
    *,
    modes: tuple[str, ...] | None = None,
    setups: tuple[str, ...] | None = None,
    throws: int | None = None,
    seed: int = 0,
    ycb: Path | None = None,
    seconds: float | None = None,
    long_seconds: float | None = None,
) -> Settings:
    """The full settings, or the quick ones, where None leaves them as they are."""
    base = QUICK if quick else Settings()
    budget = replace(
        base.budget,
        seconds=base.budget.seconds if seconds is None else seconds,
        long_seconds=base.budget.long_seconds if long_seconds is None else long_seconds,
    )
    return replace(
        base,
        modes=modes or base.modes,
        setups=setups or base.setups,
        throws=throws or base.throws,
        seed=seed,
        ycb=ycb,
        budget=budget,
    )
