"""pdoik view: drag targets and obstacles in a browser, replay logs, see what is reached."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import pdoik
from pdoik._extras import asks_for
from pdoik.descriptions import shipped_name, urdf_file

from .interrupts import end_now, noted
from .messages import misuse_fails, out
from .obstacles import load_obstacles, refuse_attached
from .options import (
    GOAL,
    ROBOT,
    BaseCollision,
    BaseLink,
    Clearance,
    CloudFile,
    Goal,
    GoalAxis,
    HullsFile,
    Leaf,
    Method,
    Radii,
    SceneFile,
    SceneFrame,
    SceneWithout,
    SelfCollision,
    SrdfFile,
)
from .path_options import Closed, Free, Spacing
from .report_folders import report_folder
from .robots import (
    ANY_ROBOT,
    PackageDirs,
    XacroArguments,
    load_robot,
    numbers,
    package_places,
    xacro_arguments,
)

if TYPE_CHECKING:
    from pdoik.view.server import PageServer

_DEFAULTS = pdoik.Options()
_PAGE = "Page"  # panel


def view(
    context: typer.Context,
    what: Annotated[
        str | None,
        typer.Argument(
            help=f"{ANY_ROBOT}; or the folder of a diagnosis. Without: a Panda among shapes.",
            metavar="ROBOT|REPORT",
        ),
    ] = None,
    base_link: BaseLink = None,
    tip_link: Annotated[
        list[str] | None,
        typer.Option(
            help="Link to drag, repeatable; the shipped robot's own or every leaf otherwise.",
            rich_help_panel=ROBOT,
        ),
    ] = None,
    occupancy: HullsFile = None,
    srdf: SrdfFile = None,
    package_dir: PackageDirs = None,
    xacro_arg: XacroArguments = None,
    q0: Annotated[
        str | None,
        typer.Option(
            help="First posture, one number per joint; H1's stance or mid-range otherwise.",
            rich_help_panel=ROBOT,
        ),
    ] = None,
    goal: Annotated[
        Goal | None,
        typer.Option(
            help="What of each target counts; pose otherwise, or position where joints are few.",
            rich_help_panel=GOAL,
        ),
    ] = None,
    goal_axis: GoalAxis = "z",
    method: Annotated[
        Method,
        typer.Option(help="'paper' is the paper's algorithm.", rich_help_panel=GOAL),
    ] = "default",
    max_time: Annotated[
        float, typer.Option(help="Deadline of a solve, seconds.", rich_help_panel=GOAL)
    ] = 0.02,
    self_collision: SelfCollision = None,
    cloud: CloudFile = None,
    scene: SceneFile = None,
    frame: SceneFrame = None,
    without: SceneWithout = None,
    leaf: Leaf = 0.02,
    radii: Radii = True,
    clearance: Clearance = _DEFAULTS.clearance,
    base_collision: BaseCollision = _DEFAULTS.base_collision,
    replay: Annotated[
        Path | None,
        typer.Option(
            help="Log to replay, CSV: time, q.<joint>, q_des.<joint>, dq.<joint>, tau.<joint>.",
            rich_help_panel=_PAGE,
        ),
    ] = None,
    path: Annotated[
        Path | None,
        typer.Option(
            help="Path to follow and to play, as pdoik path reads it: .csv or .yaml.",
            rich_help_panel=_PAGE,
        ),
    ] = None,
    free: Free = None,
    spacing: Spacing = None,
    closed: Closed = False,
    reach: Annotated[
        Path | None,
        typer.Option(
            help="Reachability map to show, as Reachability.save or the page wrote it.",
            rich_help_panel=_PAGE,
        ),
    ] = None,
    host: Annotated[
        str,
        typer.Option(
            help="Address to listen on; any other than this lets others drag the robot, too.",
            rich_help_panel=_PAGE,
        ),
    ] = "127.0.0.1",
    port: Annotated[
        int | None,
        typer.Option(
            min=0, max=65535, help="0 for any; 8080 or the next otherwise.", rich_help_panel=_PAGE
        ),
    ] = None,
    no_open: Annotated[
        bool, typer.Option("--no-open", help="Do not open a browser.", rich_help_panel=_PAGE)
    ] = False,
) -> None:
    """Open a page to drag a robot's target and its obstacles, or to see a diagnosis.

    Without arguments: a Panda among shapes, and a menu of what else there is.

    Pull the arrows at a tip or an obstacle, and the robot follows; with
    several tips the others hold. Sliders pose the joints. Robots, clouds,
    scenes and logs can be uploaded there, and maps of what the robot reaches
    computed.

    The folder that pdoik diagnose wrote shows the robot as recorded and as
    simulated, before and after the findings.

    It listens on this machine alone. Ctrl-C ends it.

    [bold]Examples[/]:
    pdoik view
    pdoik view arm.urdf --scene table.yaml --cloud scan.pcd
    pdoik view panda --scene table.yaml --path seam.csv --free z --spacing 0.01
    pdoik view report
    """
    with asks_for("view"):
        import viser  # noqa: F401
    if what is not None:
        with misuse_fails():
            folder = report_folder(what)
        if folder is not None:
            _view_report(folder, package_dir, host, port, no_open=no_open)
            return
    from pdoik.view import Session, load_log
    from pdoik.view.examples import EXAMPLES
    from pdoik.view.model import shipped_model, urdf_model
    from pdoik.view.reach import load_map
    from pdoik.view.viewer import Viewer

    if _nothing_asked(context):
        example = EXAMPLES[0]
        model, session = example.make()
        with _page(host, port, no_open=no_open) as (server, hold):
            viewer = Viewer(server, model, session, example, read_path=_stations)
            hold()
            viewer.forget_uploads()
        return
    robot = what or "panda"
    loaded = load_robot(
        robot, base_link, tip_link, occupancy, srdf, packages=package_dir, arguments=xacro_arg
    )
    with misuse_fails():
        if shipped_name(robot) is not None:
            model = shipped_model(loaded)
        else:
            places = package_places(package_dir)
            file = urdf_file(robot, arguments=xacro_arguments(xacro_arg), packages=places)
            model = urdf_model(loaded, file, places)
        options = pdoik.Options(
            goal=goal or "pose",
            goal_axis=goal_axis,
            method=method,
            clearance=clearance,
            base_collision=base_collision,
            max_time=max_time,
            self_collision=self_collision,
        )
        goals = None if goal is None else dict.fromkeys(loaded.tip_links, goal)
    with misuse_fails("--q0" if q0 is not None else ""):
        posture = None if q0 is None else numbers(q0, loaded)
        session = Session(loaded, options, posture, goals=goals)
    session.set_thinning(leaf, radii)
    obstacles = load_obstacles(
        cloud, leaf, radii, scene, loaded, frame=frame, without=without or ()
    )
    refuse_attached(obstacles)
    if obstacles is not None:
        with misuse_fails(f"--scene {scene}"):
            session.set_cloud(obstacles.surface)
            if obstacles.scene is not None:
                session.set_shapes(obstacles.shapes, obstacles.scene.contacts)
    with misuse_fails("--replay" if replay is not None else ""):
        log = None if replay is None else load_log(replay, loaded.joint_names)
    if path is not None:
        with misuse_fails("--path"):
            stations = _stations(path, free, spacing)
    with misuse_fails("--reach" if reach is not None else ""):
        reach_map = None if reach is None else load_map(reach, loaded)
    with _page(host, port, no_open=no_open) as (server, hold):
        viewer = Viewer(
            server, model, session, read_path=partial(_stations, free=free, spacing=spacing)
        )
        if path is not None:
            with misuse_fails(f"--path {path}"):
                viewer.follow_path(path.name, stations, closed=closed)
        if log is not None:
            viewer.replay_tab.load(log)
        if reach is not None and reach_map is not None:
            viewer.reach_tab.map.show(reach_map, f"from {reach.name}")
        hold()
        viewer.forget_uploads()  # all that would outlive the process


def _stations(path: Path, free: str | None = None, spacing: float | None = None) -> Any:
    """Stations of a path's file, as `pdoik.Solver.solve_path` takes them."""
    from .path_file import read_path_file

    return read_path_file(path, free).stations(free, spacing)


def _nothing_asked(context: typer.Context) -> bool:
    """Whether no option says what to show: those of the page alone do not."""
    given = {
        name
        for name in context.params
        if (source := context.get_parameter_source(name)) is None or source.name != "DEFAULT"
    }
    return given <= {"host", "port", "no_open"}


def _view_report(
    folder: Path, package_dir: list[str] | None, host: str, port: int | None, *, no_open: bool
) -> None:
    """The page of a diagnosis."""
    with asks_for("sim2real"), misuse_fails():
        from pdoik.view.diagnosis.report import load_report
        from pdoik.view.diagnosis.viewer import DiagnosisViewer

        report = load_report(folder)
        places = package_places(package_dir)
    with _page(host, port, no_open=no_open) as (server, hold):
        DiagnosisViewer(server, report, places)
        hold()


@contextmanager
def _page(
    host: str, port: int | None, *, no_open: bool
) -> Iterator[tuple[PageServer, Callable[[], None]]]:
    """A server, and what to call once its page is there: it returns when Ctrl-C comes."""
    from pdoik.view.server import open_browser, start_server

    with noted() as stop:  # from before it listens: the page answers before start_server returns
        with misuse_fails(f"--host {host}" if port is None else f"--host {host} --port {port}"):
            server = start_server(host, port)

        def hold() -> None:
            out.print(f"{server.url}  (Ctrl-C ends it)", highlight=False)
            if not no_open and stop.empty():
                open_browser(server.url)
            stop.get()

        yield server, hold
        end_now()
