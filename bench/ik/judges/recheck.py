"""Checks solutions again by plain NumPy, from the robot's URDF text and the paper's inequalities.

Nothing here calls the library's kinematics: a success of the solver that this does not confirm is a
defect of one of the two.
"""

import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import pdoik
from bench.common.arrays import FloatArray, moved
from bench.ik.judges.distances import hull_distance, to_segment


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """What a configuration is worth."""

    position_error: float  # [m]
    rotation_error: float  # [rad]
    limit_violation: float  # [rad]
    clearance: float
    """Least of half the sum of a point's distances to the foci, minus a; of points with a radius
    their distance to the hull, minus the radius [m]."""

    def confirms(self, options: pdoik.Options) -> bool:
        """Whether a solver with these options may call it a solution, up to rounding."""
        return (
            self.position_error <= options.position_tolerance + 1e-9
            and self.rotation_error <= options.rotation_tolerance + 1e-9
            and self.limit_violation <= 1e-9
            and self.clearance >= options.clearance - options.clearance_tolerance - 1e-9
        )


class UrdfChain:
    """Forward kinematics of a URDF with fixed, revolute and continuous joints, by definition."""

    def __init__(self, urdf: str | Path, joint_names: Sequence[str]) -> None:
        self._joints: dict[str, tuple[str, FloatArray, FloatArray, int | None]] = {}
        self.limits = np.full((len(joint_names), 2), (-np.inf, np.inf))
        for joint in ElementTree.parse(urdf).iterfind("joint"):
            kind, name = joint.attrib["type"], joint.attrib["name"]
            if kind not in {"fixed", "revolute", "continuous"}:
                raise ValueError(f"{urdf}: joint {name} is {kind}, expected fixed or revolute")
            origin = joint.find("origin")
            T = np.eye(4)
            T[:3, 3] = _numbers(origin, "xyz", "0 0 0")
            rpy = zip(np.eye(3), _numbers(origin, "rpy", "0 0 0"), strict=True)
            x, y, z = (rotation_about(unit, angle) for unit, angle in rpy)
            T[:3, :3] = z @ y @ x
            axis = _numbers(joint.find("axis"), "xyz", "1 0 0")
            index = None if kind == "fixed" else list(joint_names).index(name)
            if index is not None and kind == "revolute":
                limit = joint.find("limit")
                self.limits[index] = [float(limit.attrib[end]) for end in ("lower", "upper")]
            child = joint.find("child").attrib["link"]
            parent = joint.find("parent").attrib["link"]
            self._joints[child] = (parent, T, axis / np.linalg.norm(axis), index)

    def fk(self, q: FloatArray, link: str) -> FloatArray:
        """Pose of a link in the root's frame, (4, 4)."""
        T = np.eye(4)
        while link in self._joints:
            link, T_parent_joint, axis, index = self._joints[link]
            turn = np.eye(4)
            if index is not None:
                turn[:3, :3] = rotation_about(axis, float(q[index]))
            T = T_parent_joint @ turn @ T
        return T


def recheck(
    chain: UrdfChain,
    robot: pdoik.Robot,
    options: pdoik.Options,
    T_base_tip: FloatArray,
    q: FloatArray,
    points: FloatArray,
) -> Verdict:
    """Errors, limits and the inside test |u1 - o| + |u2 - o| >= 2 a for every hull and point.

    The robot gives its hulls and the names of its links; points are (N, 3), or (N, 4) with a
    radius each [m].
    """
    T = chain.fk(q, robot.tip_links[0])
    clearance = np.inf
    if len(points):
        poses = {link: chain.fk(q, link) for link in robot.link_names}
        clearance = hull_clearance(robot.occupancy, poses, points)
    return Verdict(
        position_error=float(np.linalg.norm(T[:3, 3] - T_base_tip[:3, 3])),
        rotation_error=_rotation_error(options, T[:3, :3], T_base_tip[:3, :3]),
        limit_violation=float(np.max([chain.limits[:, 0] - q, q - chain.limits[:, 1], 0 * q])),
        clearance=clearance,
    )


def hull_clearance(
    occupancy: pdoik.Occupancy, poses: Mapping[str, FloatArray], points: FloatArray
) -> float:
    """The least over all hulls and points, see Verdict; of a link with capsules only these [m].

    What is in a capsule is as far from its link's pieces as the nearest one's planes say.
    """
    centres = points[:, :3]
    radii = points[:, 3] if points.shape[1] == 4 else np.zeros(len(points))

    def place(link: str, local: Sequence[float]) -> FloatArray:
        return moved(np.array(local), poses[link])

    pieces: dict[str, list[FloatArray]] = {}
    for link, vertices, triangles, _ in occupancy.pieces:
        pieces.setdefault(link, []).append(np.array(vertices)[np.array(triangles)])
    distances = []
    for link, a, b, radius, *_ in occupancy.capsules:
        gaps = to_segment(centres, place(link, a), place(link, b)) - radius
        inside = gaps < radii
        if inside.any() and link in pieces:
            local = moved(centres[inside], np.linalg.inv(poses[link]))
            off = np.min([_above(local, faces) for faces in pieces[link]], axis=0)
            gaps[inside] = np.maximum(gaps[inside], off)
        distances.append(gaps)
    closer = {capsule[0] for capsule in occupancy.capsules}
    distances += [
        np.linalg.norm(centres - place(link, center), axis=1) - radius
        for link, center, radius in occupancy.spheres
        if link not in closer
    ]
    for link_a, focus_a, link_b, focus_b, semi_major in occupancy.spheroids:
        if closer & {link_a, link_b}:
            continue
        foci = place(link_a, focus_a), place(link_b, focus_b)
        gaps = sum(np.linalg.norm(centres - focus, axis=1) for focus in foci) / 2 - semi_major
        # A gap is never more than the distance, so only those below the radius need the latter.
        near = (radii > 0) & (gaps > 0) & (gaps < radii)
        if near.any():
            gaps[near] = spheroid_distance(centres[near], *foci, semi_major)
        distances.append(gaps)
    return min((float((gaps - radii).min()) for gaps in distances), default=np.inf)


def _above(points: FloatArray, faces: FloatArray) -> FloatArray:
    """Heights of points (N, 3) over the highest plane of a convex surface's triangles, (N,) [m]."""
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    normals, corners = normals[lengths > 0] / lengths[lengths > 0, None], faces[lengths > 0, 0]
    heights = points @ normals.T - np.einsum("fi,fi->f", normals, corners)
    return np.asarray(heights.max(axis=1))


def spheroid_distance(
    points: FloatArray, a: FloatArray, b: FloatArray, semi_major: float
) -> FloatArray:
    """Distance of points (K, 3) to the surface of one spheroid with foci a and b, (K,) [m]."""
    a, b = np.broadcast_to(a, points.shape), np.broadcast_to(b, points.shape)
    return hull_distance(points, a, b, np.full(len(points), semi_major))


def _rotation_error(options: pdoik.Options, R_is: FloatArray, R_wanted: FloatArray) -> float:
    """The angle between two frames, or between two axes, or nothing, as the goal has it [rad]."""
    if options.goal == "position":
        return 0.0
    if options.goal == "axis":
        named = options.goal_axis
        axis = np.eye(3)["xyz".index(named)] if isinstance(named, str) else np.asarray(named)
        a, b = R_is @ axis, R_wanted @ axis
        return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
    R = R_is.T @ R_wanted
    sine = np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return float(np.arctan2(sine, np.trace(R) - 1))


def rotation_about(axis: FloatArray, angle: float) -> FloatArray:
    """Rodrigues' formula about a unit axis."""
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def _numbers(element: ElementTree.Element | None, name: str, default: str) -> FloatArray:
    text = default if element is None else element.attrib.get(name, default)
    return np.array([float(number) for number in text.split()])
