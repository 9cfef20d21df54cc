"""The judge: coal on a robot's published meshes against the true shapes, and Pinocchio's pose.

Nothing here comes from the library that is judged. Links are triangles (or the description's own
primitives), solids are coal's exact shapes.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import coal
import numpy as np
import numpy.typing as npt
import pinocchio
from scipy.spatial import ConvexHull

from bench.ik.judges.meshes import is_inside
from bench.ik.problems.problem import Contact, Problem
from bench.ik.problems.robots import Meshes, RobotFiles
from bench.ik.problems.solids import Solid

FloatArray = npt.NDArray[np.float64]
POSES = 100  # random ones, that tell which pairs of links always touch, where no SRDF does
ALWAYS = 0.95  # of them
BALANCE = 1e-3  # how far outside the feet the centre of mass may be [m]
KIND = {"visual": pinocchio.VISUAL, "collision": pinocchio.COLLISION}


class Judge:
    """Says what a configuration touches and how far it misses its targets.

    Args:
        files: The robot.
        meshes: "visual" for the meshes that one sees, "collision" for the coarser ones.
        joint_names: The order of q; None for Pinocchio's.

    Raises:
        ValueError: A joint of `joint_names` is not in the description.
    """

    def __init__(
        self, files: RobotFiles, meshes: Meshes = "visual", joint_names: Sequence[str] | None = None
    ) -> None:
        self.files, self.meshes = files, meshes
        xml = files.xml()
        self._model = pinocchio.buildModelFromXML(xml)
        self._data = self._model.createData()
        self._geometry = pinocchio.buildGeomFromUrdfString(
            self._model, xml, KIND[meshes], package_dirs=[str(d) for d in files.package_dirs]
        )
        self._order(joint_names)
        self._base = self._model.getFrameId(files.base) if files.base else 0
        self._links = [_Link.of(self._model, item) for item in self._geometry.geometryObjects]
        self._pairs = self._self_pairs()

    def _order(self, joint_names: Sequence[str] | None) -> None:
        known = list(self._model.names)[1:]
        self.joint_names = tuple(known if joint_names is None else joint_names)
        for name in self.joint_names:
            if name not in known:
                raise ValueError(f"{self.files.urdf}: joint {name!r} is not one of {known}")
        joints = [self._model.joints[self._model.getJointId(name)] for name in self.joint_names]
        self._where = [(joint.idx_q, joint.nq) for joint in joints]
        lower, upper = [], []
        for at, count in self._where:
            limited = count == 1
            lower.append(self._model.lowerPositionLimit[at] if limited else -np.pi)
            upper.append(self._model.upperPositionLimit[at] if limited else np.pi)
        self.lower, self.upper = np.array(lower), np.array(upper)
        self.endless = np.array([count == 2 for _, count in self._where])

    @property
    def link_names(self) -> list[str]:
        """The links of the description."""
        return [f.name for f in self._model.frames if f.type == pinocchio.FrameType.BODY]

    @property
    def dof(self) -> int:
        return len(self.joint_names)

    def random(self, rng: np.random.Generator) -> FloatArray:
        """A configuration uniform within the limits, (n,) [rad] or [m]."""
        return rng.uniform(self.lower, self.upper)

    def fk(self, q: FloatArray, link: str) -> FloatArray:
        """T_base_link, (4, 4)."""
        self._move(q)
        return self._in_base(self._frame(link))

    def jacobian(self, q: FloatArray, link: str) -> FloatArray:
        """Of a link's frame in that frame: linear rows first, (6, n) in q's order."""
        frame, full_q = self._frame(link), self._expand(q)
        full = pinocchio.computeFrameJacobian(
            self._model, self._data, full_q, frame, pinocchio.LOCAL
        )
        self._move(q)
        if self._base:  # which moves against the description's root
            of_base = pinocchio.computeFrameJacobian(
                self._model, self._data, full_q, self._base, pinocchio.LOCAL
            )
            T_link_base = self._data.oMf[frame].inverse() * self._data.oMf[self._base]
            full = full - T_link_base.action @ of_base
        columns = [self._model.joints[self._model.getJointId(n)].idx_v for n in self.joint_names]
        return np.asarray(full[:, columns])

    def left_out_pairs(self) -> set[tuple[str, str]]:
        """Pairs of links that are never looked at; what is judged may ignore them, too."""
        names = sorted({link.name for link in self._links})
        looked_at = {frozenset((self._links[a].name, self._links[b].name)) for a, b in self._pairs}
        pairs = {(a, b) for k, a in enumerate(names) for b in names[k + 1 :]}
        return {pair for pair in pairs if frozenset(pair) not in looked_at}

    def off_balance(self, q: FloatArray, contacts: Mapping[str, FloatArray]) -> float:
        """How far the centre of mass is outside the contacts' hull, seen from above [m].

        Args:
            q: (n,) [rad] or [m].
            contacts: Points by which links stand, (K, 3) in each link's frame [m]; empty for a
                robot that stands otherwise. The base frame's z is up.
        """
        if not contacts:
            return 0.0
        self._move(q)
        center = self._T_base_root.act(self._center_of_mass(q))[:2]
        places = [(self._in_base(self._frame(link)), points) for link, points in contacts.items()]
        ground = np.concatenate([points @ T[:3, :3].T + T[:3, 3] for T, points in places])
        edges = ConvexHull(ground[:, :2]).equations
        return max(0.0, float((edges[:, :2] @ center + edges[:, 2]).max()))

    def _center_of_mass(self, q: FloatArray) -> FloatArray:
        """In the root's frame, (3,) [m]; Pinocchio's own is without the root's mass."""
        moving = pinocchio.computeTotalMass(self._model)
        center = pinocchio.centerOfMass(self._model, self._data, self._expand(q))
        root = self._model.inertias[0]
        return np.asarray(
            (moving * center + root.mass * root.lever) / (moving + root.mass), dtype=np.float64
        )

    def touching(
        self, q: FloatArray, solids: Sequence[Solid], allowed: Collection[Contact] = ()
    ) -> str | None:
        """The first pair found, as "link and solid" or "link and link"; None if all is clear.

        Args:
            q: (n,) [rad] or [m].
            solids: In the frame of the robot's base link.
            allowed: Pairs of a link and a solid that may touch.
        """
        return self.touches_itself(q) or self._touches(q, solids, allowed)

    def touches_itself(self, q: FloatArray) -> str | None:
        """The first pair of links that touch, but for neighbours and what the SRDF leaves out."""
        self._move(q)
        poses = [self._pose(link) for link in self._links]
        for a, b in self._pairs:
            if self._links[a].far_from(self._links[b], poses[a], poses[b]):
                continue
            if _collide(self._links[a].shape, poses[a], self._links[b].shape, poses[b]):
                return f"{self._links[a].name} and {self._links[b].name}"
        return None

    def _touches(
        self, q: FloatArray, solids: Sequence[Solid], allowed: Collection[Contact]
    ) -> str | None:
        self._move(q)
        prepared = [_Obstacle(solid) for solid in solids]
        for link in self._links:
            T = self._pose(link)
            for obstacle in prepared:
                if (link.name, obstacle.solid.name) in allowed:
                    continue
                if obstacle.touches(link, T):
                    return f"{link.name} and {obstacle.solid.name}"
        return None

    def misses(
        self, q: FloatArray, targets: Mapping[str, FloatArray], position: float, rotation: float
    ) -> str | None:
        """What is wrong with a configuration as an answer, in words; None for nothing.

        Args:
            q: (n,) [rad] or [m].
            targets: By tip, (4, 4).
            position: Tolerance [m].
            rotation: Tolerance [rad].
        """
        outside = np.maximum(q - self.upper, self.lower - q)
        outside[self.endless] = 0.0
        if outside.max() > 1e-9:
            return f"{self.joint_names[int(outside.argmax())]} is {outside.max():.2g} out of limits"
        self._move(q)
        for tip, T in targets.items():
            gap = np.linalg.inv(T) @ self._in_base(self._frame(tip))
            far, turned = np.linalg.norm(gap[:3, 3]), np.linalg.norm(pinocchio.log3(gap[:3, :3]))
            if far > position + 1e-9 or turned > rotation + 1e-9:
                return f"{tip} misses by {far:.2g} m and {turned:.2g} rad"
        return None

    def is_good(self, problem: Problem, q: FloatArray) -> bool:
        """Whether a configuration touches nothing that it may not, and stands."""
        return self.fault(problem, q) is None

    def fault(self, problem: Problem, q: FloatArray) -> str | None:
        """What is wrong with a configuration but for the targets, in words; None for nothing."""
        off = self.off_balance(q, problem.contacts)
        if off > BALANCE:
            return f"the centre of mass is {off:.2g} m outside the feet"
        return self.touching(q, problem.solids, problem.allowed)

    def link_surfaces(self, q: FloatArray) -> list[tuple[str, FloatArray]]:
        """Triangles of each link that is a mesh, (T, 3, 3) in the base frame, for pictures."""
        self._move(q)
        surfaces = []
        for link in self._links:
            if link.triangles is not None:
                T = self._pose(link)
                R = np.asarray(T.getRotation())
                surfaces.append((link.name, link.triangles @ R.T + np.asarray(T.getTranslation())))
        return surfaces

    def _expand(self, q: FloatArray) -> FloatArray:
        full = pinocchio.neutral(self._model)
        for value, (at, count) in zip(q, self._where, strict=True):
            full[at : at + count] = value if count == 1 else (np.cos(value), np.sin(value))
        return full

    def _move(self, q: FloatArray) -> None:
        pinocchio.framesForwardKinematics(self._model, self._data, self._expand(q))
        self._T_base_root = self._data.oMf[self._base].inverse()

    def _frame(self, link: str) -> int:
        if not self._model.existFrame(link):
            raise ValueError(f"{self.files.urdf}: no link {link!r}")
        return self._model.getFrameId(link)

    def _in_base(self, frame: int) -> FloatArray:
        return np.asarray((self._T_base_root * self._data.oMf[frame]).homogeneous)

    def _pose(self, link: _Link) -> Any:
        T = self._T_base_root * self._data.oMi[link.joint] * link.T_joint
        return coal.Transform3s(T.rotation, T.translation)

    def _self_pairs(self) -> list[tuple[int, int]]:
        """Pairs of pieces to look at: not joined, and not left out by the SRDF.

        Without an SRDF, links two joints apart and pairs that touch in nearly all of POSES random
        configurations are left out, as MoveIt's assistant leaves them out.
        """
        geometry, model = self._geometry, self._model
        geometry.addAllCollisionPairs()
        if self.files.srdf is not None:
            pinocchio.removeCollisionPairs(model, geometry, str(self.files.srdf))
        near = 1 if self.files.srdf is not None else 2
        pairs = [
            (pair.first, pair.second)
            for pair in geometry.collisionPairs
            if self._joints_between(pair.first, pair.second) > near
        ]
        return pairs if self.files.srdf is not None else self._not_always_touching(pairs)

    def _joints_between(self, a: int, b: int) -> int:
        """How many joints lie between two pieces' links."""
        up, other = (list(self._model.supports[self._links[k].joint]) for k in (a, b))
        return len(set(up) ^ set(other))

    def _not_always_touching(self, pairs: list[tuple[int, int]]) -> list[tuple[int, int]]:
        rng = np.random.default_rng(0)
        open_pairs, clear, kept = set(pairs), dict.fromkeys(pairs, 0), set()
        for _ in range(POSES):
            self._move(self.random(rng))
            poses = [self._pose(link) for link in self._links]
            for a, b in sorted(open_pairs):
                first, second = self._links[a], self._links[b]
                if first.far_from(second, poses[a], poses[b]) or not _collide(
                    first.shape, poses[a], second.shape, poses[b]
                ):
                    clear[a, b] += 1
                    if clear[a, b] > (1 - ALWAYS) * POSES:
                        kept.add((a, b))
            open_pairs -= kept
        return [pair for pair in pairs if pair in kept]


class _Link:
    """A piece of a link's geometry."""

    def __init__(self, name: str, joint: int, T_joint: Any, shape: Any) -> None:
        self.name, self.joint, self.T_joint = name, joint, T_joint
        self.shape = shape
        shape.computeLocalAABB()
        self.center, self.radius = np.asarray(shape.aabb_center), float(shape.aabb_radius)
        self.triangles: FloatArray | None = None
        if isinstance(shape, coal.BVHModelBase):
            vertices = np.asarray(shape.vertices())
            triangles = [shape.tri_indices(i) for i in range(shape.num_tris)]
            corners = np.array([[t[0], t[1], t[2]] for t in triangles])
            self.triangles = vertices[corners]

    @classmethod
    def of(cls, model: Any, item: Any) -> _Link:
        name = model.frames[item.parentFrame].name
        return cls(name, item.parentJoint, item.placement, item.geometry)

    def far_from(self, other: _Link, T: Any, T_other: Any) -> bool:
        gap = np.linalg.norm(T.transform(self.center) - T_other.transform(other.center))
        return bool(gap > self.radius + other.radius)


class _Obstacle:
    """A solid, ready for coal."""

    def __init__(self, solid: Solid) -> None:
        self.solid, self.shape = solid, solid.geometry()
        self.T = coal.Transform3s(solid.T[:3, :3], solid.T[:3, 3])
        self._bounded = solid.kind != "half_space"
        if self._bounded:
            self.shape.computeLocalAABB()
            self._radius = float(self.shape.aabb_radius)
            self._center = self.T.transform(np.asarray(self.shape.aabb_center))

    def touches(self, link: _Link, T: Any) -> bool:
        """Whether surfaces meet, or one holds the other."""
        if self._bounded:
            gap = np.linalg.norm(T.transform(link.center) - self._center)
            if gap > link.radius + self._radius:
                return False
        if _collide(link.shape, T, self.shape, self.T):
            return True
        if link.triangles is None:
            return False
        within = T.inverse().transform(self.T.transform(self._point()))
        held = self._bounded and np.linalg.norm(within - link.center) < link.radius
        if held and is_inside(within, link.triangles):
            return True
        return self.solid.kind == "mesh" and self._holds(T.transform(link.triangles[0, 0]))

    def _point(self) -> FloatArray:
        """Some point of the solid, in its own frame."""
        return self.solid.vertices[0] if self.solid.kind == "mesh" else np.zeros(3)

    def _holds(self, point: FloatArray) -> bool:
        triangles = self.solid.vertices[self.solid.faces]
        return is_inside(self.T.inverse().transform(point), triangles)


def _collide(a: Any, T_a: Any, b: Any, T_b: Any) -> bool:
    result = coal.CollisionResult()
    coal.collide(a, T_a, b, T_b, coal.CollisionRequest(), result)
    return bool(result.isCollision())
