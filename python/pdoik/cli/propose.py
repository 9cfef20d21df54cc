"""pdoik propose: the motion that settles what a diagnosis leaves open."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.markup import escape

import pdoik
from pdoik._extras import asks_for
from pdoik.descriptions import shipped_name

from .messages import err, fail, misuse_fails, out, warn
from .obstacles import check_files, load_obstacles, refuse_attached
from .options import (
    OBSTACLES,
    ROBOT,
    Clearance,
    CloudFile,
    HullsFile,
    Leaf,
    Radii,
    SceneFile,
    SceneFrame,
    SceneWithout,
    SrdfFile,
)
from .robots import ANY_ROBOT, load_robot
from .story import story

if TYPE_CHECKING:
    from pdoik.sim2real.propose import Clear, Proposal

Base = StrEnum("Base", {"hang": "hang", "stand": "stand"})
NOTHING = 3  # exit status where there is nothing to settle
_DEFAULTS = pdoik.Options()
_LIMITS = "Limits"  # panel


def propose(
    report: Annotated[Path, typer.Argument(help="Folder of pdoik diagnose.")],
    output: Annotated[Path, typer.Option("--out", help="CSV to write; JSON next to it.")] = Path(
        "motion.csv"
    ),
    seconds: Annotated[float, typer.Option(help="Length of the motion.")] = 20.0,
    rate: Annotated[float, typer.Option(help="Rows a second.")] = 100.0,
    start: Annotated[
        str | None,
        typer.Option(help="Pose to start and end in; the first recording's start otherwise."),
    ] = None,
    base: Annotated[
        Base | None,
        typer.Option(help="How a base that floats is carried; as it was recorded otherwise."),
    ] = None,
    figures: Annotated[
        bool,
        typer.Option(
            "--figures", help="By which all joints' figures are known best, not findings."
        ),
    ] = False,
    random: Annotated[
        bool, typer.Option("--random", help="A random motion within the same limits, to compare.")
    ] = False,
    seed: Annotated[int, typer.Option(min=0, help="Of the search.")] = 0,
    search: Annotated[float, typer.Option(help="Seconds to search, about.")] = 60.0,
    study: Annotated[
        Path | None, typer.Option(help="The study, if it is elsewhere than when diagnosed.")
    ] = None,
    speed_share: Annotated[
        float, typer.Option(help="Of the speed limits.", rich_help_panel=_LIMITS)
    ] = 0.7,
    torque_share: Annotated[
        float, typer.Option(help="Of the torque limits.", rich_help_panel=_LIMITS)
    ] = 0.8,
    acceleration: Annotated[
        float | None,
        typer.Option(
            help="Of every joint, rad/s^2; the speed limit in 0.4 s otherwise.",
            rich_help_panel=_LIMITS,
        ),
    ] = None,
    max_speed: Annotated[
        float | None,
        typer.Option(help="Of joints whose description has none, rad/s.", rich_help_panel=_LIMITS),
    ] = None,
    max_torque: Annotated[
        float | None,
        typer.Option(help="Of joints whose description has none, N m.", rich_help_panel=_LIMITS),
    ] = None,
    robot: Annotated[
        str | None,
        typer.Option(
            help=f"Robot that --occupancy fits: {ANY_ROBOT}; the study's otherwise.",
            rich_help_panel=ROBOT,
        ),
    ] = None,
    occupancy: HullsFile = None,
    srdf: SrdfFile = None,
    cloud: CloudFile = None,
    scene: SceneFile = None,
    frame: SceneFrame = None,
    without: SceneWithout = None,
    leaf: Leaf = 0.02,
    radii: Radii = True,
    clearance: Clearance = _DEFAULTS.clearance,
    margin: Annotated[
        float,
        typer.Option(
            help="Least distance between the robot's own hulls.", rich_help_panel=OBSTACLES
        ),
    ] = 0.0,
) -> None:
    """Propose the motion that separates best what a diagnosis could not distinguish.

    Where a finding lists equivalents, or is less sure than 0.9, the motion along which these
    predict torques as different as can be, from rest to rest, within limits of position, speed,
    acceleration and torque. A base that floats hangs, or stands on its feet: then the motion is
    small and slow, and was run in MuJoCo with the study's gains. With hulls (--occupancy, or
    --robot panda) it keeps off the points of --cloud and the shapes of --scene, and, with an SRDF,
    off the robot itself. A scene may have the robot, which is left out. Without hulls only limits
    are kept, and that is said. The CSV has time, q_des.<joint> and dq_des.<joint>; pdoik view
    replays it.

    Exit status: 0 a motion was written, 3 there is nothing to settle, 2 something cannot be read.

    [bold]Example[/]: pdoik propose report/ --seconds 20 --out motion.csv
    """
    _check(report, output)
    with asks_for("sim2real"), misuse_fails():
        from pdoik.sim2real.propose import NothingToSettleError, Wishes
        from pdoik.sim2real.propose import propose as proposed

        check_files(cloud, scene)
        options = pdoik.Options(clearance=clearance, self_clearance=margin, base_collision=False)

        def clear(joints: tuple[str, ...], text: str, tip: str | None) -> Clear | None:
            loaded = (
                _of_text(text, tip, occupancy, srdf)
                if robot is None
                else load_robot(robot, None, None if shipped_name(robot) else tip, occupancy, srdf)
            )
            obstacles = load_obstacles(
                cloud, leaf, radii, scene, loaded, frame=frame, without=without or ()
            )
            refuse_attached(obstacles)
            return _clear(loaded, joints, None if obstacles is None else obstacles.kept(), options)

        wishes = Wishes(
            seconds=seconds,
            rate=rate,
            speed_share=speed_share,
            torque_share=torque_share,
            acceleration=acceleration,
            max_speed=max_speed,
            max_torque=max_torque,
            base=None if base is None else base.value,
            figures=figures,
            start=None if start is None else _numbers(start),
            random=random,
            seed=seed,
            search=search,
            study=study,
            clear=clear,
        )
        try:
            with story() as tell:
                proposal = proposed(report, wishes, tell)
        except NothingToSettleError as error:
            err.print(escape(str(error)), highlight=False)
            raise typer.Exit(NOTHING) from error
        proposal.save(output)
    _print(proposal, report, output, robot)


def _check(report: Path, output: Path) -> None:
    """Leave with status 2 unless the report is there and the output may be written."""
    if report.is_file():
        fail(f"{report}: is a file, expected the folder of pdoik diagnose")
    if output.is_dir():
        fail(f"--out {output}: is a folder, expected a file")
    if output.suffix == ".json":
        fail(f"--out {output}: expected a CSV; its JSON is written next to it")
    if not output.parent.is_dir():
        fail(f"--out {output}: no such folder: {output.parent}")


def _numbers(text: str) -> np.ndarray:
    try:
        return np.array([float(word) for word in text.replace(",", " ").split()])
    except ValueError:
        raise ValueError(f"--start: expected one number for each joint, got {text!r}") from None


def _of_text(
    text: str, tip: str | None, occupancy: Path | None, srdf: Path | None
) -> pdoik.Robot | None:
    """The study's own robot, if it is a URDF."""
    import warnings

    from pdoik.errors import RobotWarning

    if "<robot" not in text:
        if occupancy is not None:
            warn("the study's robot is an MJCF: give its file with --robot, too")
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RobotWarning)
        robot = pdoik.Robot.from_urdf(text, tip_link=tip)
    if occupancy is not None:
        robot.occupancy = pdoik.Occupancy.load(str(occupancy))
    if srdf is not None:
        robot.ignored_pairs = pdoik.load_srdf_pairs(srdf, robot)
    return robot


def _clear(
    robot: pdoik.Robot | None, joints: tuple[str, ...], obstacles: object, options: pdoik.Options
) -> Clear | None:
    """What judges motions, or None with a warning where the robot has no hulls."""
    from pdoik.sim2real.propose import Clear

    if robot is None or not len(robot.occupancy):
        if obstacles is not None:
            fail(
                "--cloud, --scene: the robot has no hulls to keep off them: --occupancy FILE (see"
                " pdoik occupancy) or --robot with a shipped robot"
            )
        warn(
            "the robot has no hulls: only limits of position, speed, acceleration and torque are"
            " kept; look at the motion in pdoik view before it is run, or give --occupancy"
        )
        return None
    judge = Clear(robot, joints, obstacles, options)
    if not judge.keeps_off_itself:
        warn(
            "the robot's own links are not kept off one another: give --srdf with the pairs that"
            " may touch (see pdoik pairs)"
        )
    return judge


def _print(proposal: Proposal, report: Path, output: Path, robot: str | None) -> None:
    """What is expected, then what to do."""
    for note in proposal.notes:
        warn(note)
    for each in proposal.prospects:
        _say(
            f"[bold]{escape(each.finding)}[/]: confidence {each.confidence_before:.2f},"
            f" expected {each.confidence:.2f} after it ({escape(each.why)})"
        )
        for rival in each.rivalries:
            _say(
                f"    against {escape(rival.rival)}: log likelihood ratio"
                f" {_ratio(rival.if_own)} if it is this, {_ratio(rival.if_rival)} if that"
            )
    if proposal.figures:
        by = np.exp(np.median([each.gain for each in proposal.figures]))
        worst = min(proposal.figures, key=lambda each: each.gain)
        _say(
            f"errors of {len(proposal.figures)} figures of the joints: {by:.1f} times smaller"
            f" (median), of {worst.effect.replace('_', ' ')} at {escape(worst.joint)}"
            f" {np.exp(worst.gain):.1f} times"
        )
    for said in proposal.unsettled:
        _say(f"no motion settles {escape(said)}")
    parts = ", ".join(f"{name} {100 * share:.0f} %" for name, share in proposal.used.items())
    _say(f"of the limits it takes: {parts}")
    if proposal.verdict is not None:
        near = [
            f"{1e3 * value:.0f} mm {what}"
            for what, value in (
                ("to obstacles", proposal.verdict.clearance),
                ("between its own hulls", proposal.verdict.self_distance),
            )
            if np.isfinite(value)
        ]
        _say(f"nearest: {' and '.join(near) or 'nothing'}")
    _say(escape(f"see it: pdoik view {robot or 'ROBOT.urdf'} --replay {output}"))
    _say(escape(f"then go to the first row of {output}, run it, log it, and add the log to"))
    _say(escape("the study's recordings with 'role: fit', another one with 'role: validate'; then"))
    _say(escape(f"pdoik diagnose STUDY.yaml --out {report}"))


def _say(text: str) -> None:
    out.print(text, highlight=False)


def _ratio(value: float) -> str:
    return "unknown" if not np.isfinite(value) else f"{value:.0f}"
