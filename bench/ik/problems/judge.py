"""The judge: coal on a robot's published meshes against the true shapes, and Pinocchio's pose.

Nothing here comes from the library that is judged. Links are triangles (or the description's own
primitives), solids are coal's exact shapes.
"""

from collections.abc import Collection, Mapping, Sequence
from itertools import combinations
from typing import Any

import coal
import numpy as np
import pinocchio
from scipy.spatial import ConvexHull

from bench.common.arrays import FloatArray, moved
from bench.ik.judges.triangles import is_inside, touch
from bench.ik.problems.problem import Contact, Problem
from bench.ik.problems.robots import Meshes, RobotFiles
from bench.ik.problems.solids import Solid

POSES = 100  # random ones, that tell which pairs of links always touch, where no SRDF does
ALWAYS = 0.95  # of them
BALANCE = 1e-3  # how far outside the feet the centre of mass may be [m]
KIND = {"visual": pinocchio.VISUAL, "collision": pinocchio.COLLISION}


class Judge:
    """Says what a configuration touches and how far it misses its targets.

    Configurations are (n,) in the order of `joint_names`, Pinocchio's without them; poses and
    solids are in the frame of the robot's base link.

    Raises:
        ValueError: A joint of `joint_names` is not in the description.
    """

    def __init__(
        self,
        files: RobotFiles,
        meshes: Meshes = "visual",
        joint_names: Sequence[str] | None = None,
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
        self._links = [_Piece.of(self._model, item) for item in self._geometry.geometryObjects]
        self._pairs = self._self_pairs()

    def _order(self, joint_names: Sequence[str] | None) -> None:
        known = list(self._model.names)[1:]
        self.joint_names = tuple(known if joint_names is None else joint_names)
        for name in self.joint_names:
            if name not in known:
                raise ValueError(f"{self.files.urdf}: joint {name!r} is not one of {known}")
        joints = [self._model.joints[self._model.getJointId(name)] for name in self.joint_names]
        self._where = [(joint.idx_q, joint.nq) for joint in joints]
        self._columns = [joint.idx_v for joint in joints]
        self.endless = np.array([joint.nq == 2 for joint in joints])
        at = [joint.idx_q for joint in joints]
        self.lower = np.where(self.endless, -np.pi, self._model.lowerPositionLimit[at])
        self.upper = np.where(self.endless, np.pi, self._model.upperPositionLimit[at])

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
        return self._in_base(link)

    def jacobian(self, q: FloatArray, link: str) -> FloatArray:
        """Jacobian of a link's frame in that frame: linear rows first, (6, n) in q's order."""
        frame, full_q = self._frame(link), self._expand(q)

        def of(frame: int) -> FloatArray:
            local = pinocchio.LOCAL
            return pinocchio.computeFrameJacobian(self._model, self._data, full_q, frame, local)

        full = of(frame)
        self._move(q)
        if self._base:  # which moves against the description's root
            of_base = of(self._base)
            T_link_base = self._data.oMf[frame].inverse() * self._data.oMf[self._base]
            full = full - T_link_base.action @ of_base
        return np.asarray(full[:, self._columns])

    def left_out_pairs(self) -> set[tuple[str, str]]:
        """Pairs of links that are never looked at; what is judged may ignore them, too."""
        looked_at = {frozenset((self._links[a].name, self._links[b].name)) for a, b in self._pairs}
        names = sorted({link.name for link in self._links})
        return {pair for pair in combinations(names, 2) if frozenset(pair) not in looked_at}

    def off_balance(self, q: FloatArray, contacts: Mapping[str, FloatArray]) -> float:
        """How far the centre of mass is outside the contacts' hull, seen from above [m].

        The contacts are as a Problem has them; the base frame's z is up.
        """
        if not contacts:
            return 0.0
        self._move(q)
        center = self._T_base_root.act(self._center_of_mass(q))[:2]
        ground = np.concatenate([moved(pts, self._in_base(link)) for link, pts in contacts.items()])
        edges = ConvexHull(ground[:, :2]).equations
        return max(0.0, float((edges[:, :2] @ center + edges[:, 2]).max()))

    def _center_of_mass(self, q: FloatArray) -> FloatArray:
        """In the root's frame, (3,) [m]; Pinocchio's own is without the root's mass."""
        moving = pinocchio.computeTotalMass(self._model)
        center = pinocchio.centerOfMass(self._model, self._data, self._expand(q))
        root = self._model.inertias[0]
        return (moving * center + root.mass * root.lever) / (moving + root.mass)

    def touching(
        self, q: FloatArray, solids: Sequence[Solid], allowed: Collection[Contact] = ()
    ) -> str | None:
        """The first pair found that may not, as "link and solid" or "link and link"; or None."""
        return self.touches_itself(q) or self._touches(q, solids, allowed)

    def touches_itself(self, q: FloatArray) -> str | None:
        """The first pair of links that touch, but for neighbours and what the SRDF leaves out."""
        self._move(q)
        poses = [self._pose(link) for link in self._links]
        for a, b in self._pairs:
            if self._links[a].meets(poses[a], self._links[b], poses[b]):
                return f"{self._links[a].name} and {self._links[b].name}"
        return None

    def _touches(
        self, q: FloatArray, solids: Sequence[Solid], allowed: Collection[Contact]
    ) -> str | None:
        self._move(q)
        obstacles = [
            (_Piece.of_solid(s), coal.Transform3s(s.T[:3, :3], s.T[:3, 3])) for s in solids
        ]
        for link in self._links:
            T = self._pose(link)
            for solid, T_solid in obstacles:
                if (link.name, solid.name) in allowed:
                    continue
                if link.meets(T, solid, T_solid) or link.one_holds_the_other(T, solid, T_solid):
                    return f"{link.name} and {solid.name}"
        return None

    def misses(
        self, q: FloatArray, targets: Mapping[str, FloatArray], position: float, rotation: float
    ) -> str | None:
        """What is wrong with an answer, in words; None for nothing. Tolerances in [m] and [rad]."""
        outside = np.maximum(q - self.upper, self.lower - q)
        outside[self.endless] = 0.0
        if outside.max() > 1e-9:
            return f"{self.joint_names[int(outside.argmax())]} is {outside.max():.2g} out of limits"
        self._move(q)
        for tip, T in targets.items():
            gap = np.linalg.inv(T) @ self._in_base(tip)
            far, turned = np.linalg.norm(gap[:3, 3]), np.linalg.norm(pinocchio.log3(gap[:3, :3]))
            if far > position + 1e-9 or turned > rotation + 1e-9:
                return f"{tip} misses by {far:.2g} m and {turned:.2g} rad"
        return None

    def fault(self, problem: Problem, q: FloatArray) -> str | None:
        """What is wrong with a configuration but for the targets, in words; None for nothing."""
        off = self.off_balance(q, problem.contacts)
        if off > BALANCE:
            return f"the centre of mass is {off:.2g} m outside the feet"
        return self.touching(q, problem.solids, problem.allowed)

    def link_surfaces(self, q: FloatArray) -> list[tuple[str, FloatArray]]:
        """Triangles of each link that is a mesh, (T, 3, 3) in the base frame, for pictures."""
        self._move(q)
        poses = [(link, self._pose(link)) for link in self._links if link.triangles is not None]
        return [
            (link.name, link.triangles @ T.getRotation().T + T.getTranslation())
            for link, T in poses
        ]

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

    def _in_base(self, link: str) -> FloatArray:
        return np.asarray((self._T_base_root * self._data.oMf[self._frame(link)]).homogeneous)

    def _pose(self, link: "_Piece") -> Any:
        T = self._T_base_root * self._data.oMi[link.joint] * link.T_joint
        return coal.Transform3s(T.rotation, T.translation)

    def _self_pairs(self) -> list[tuple[int, int]]:
        """Pairs of pieces to look at: not joined, and not left out by the SRDF.

        Without an SRDF, links two joints apart and pairs that touch in nearly all of POSES random
        configurations are left out, as MoveIt's assistant leaves them out.
        """
        geometry, srdf = self._geometry, self.files.srdf
        geometry.addAllCollisionPairs()
        if srdf is not None:
            pinocchio.removeCollisionPairs(self._model, geometry, str(srdf))
        ways = [set(self._model.supports[link.joint]) for link in self._links]
        near = 1 if srdf is not None else 2
        pairs = [(pair.first, pair.second) for pair in geometry.collisionPairs]
        pairs = [(a, b) for a, b in pairs if len(ways[a] ^ ways[b]) > near]
        return pairs if srdf is not None else self._not_always_touching(pairs)

    def _not_always_touching(self, pairs: list[tuple[int, int]]) -> list[tuple[int, int]]:
        rng = np.random.default_rng(0)
        clear = dict.fromkeys(pairs, 0)
        enough = (1 - ALWAYS) * POSES
        for _ in range(POSES):
            self._move(self.random(rng))
            poses = [self._pose(link) for link in self._links]
            for (a, b), count in clear.items():
                if count <= enough:
                    clear[a, b] += not self._links[a].meets(poses[a], self._links[b], poses[b])
        return [pair for pair, count in clear.items() if count > enough]


class _Piece:
    """A piece of a link's geometry, or a solid, ready for coal."""

    def __init__(self, name: str, shape: Any, joint: int = 0, T_joint: Any = None) -> None:
        self.name, self.joint, self.T_joint, self.shape = name, joint, T_joint, shape
        self.inside = np.zeros(3)  # some point of it, in its own frame
        self.center, self.radius = self.inside, np.inf
        if not isinstance(shape, coal.Halfspace):
            shape.computeLocalAABB()
            self.center, self.radius = np.asarray(shape.aabb_center), float(shape.aabb_radius)
        self.triangles: FloatArray | None = None

    @classmethod
    def of(cls, model: Any, item: Any) -> "_Piece":
        """Make it of Pinocchio's geometry."""
        link = model.frames[item.parentFrame].name
        piece, shape = cls(link, item.geometry, item.parentJoint, item.placement), item.geometry
        if isinstance(shape, coal.BVHModelBase):
            triangles = [shape.tri_indices(i) for i in range(shape.num_tris)]
            corners = np.array([[t[0], t[1], t[2]] for t in triangles])
            piece.triangles = np.asarray(shape.vertices())[corners]
        return piece

    @classmethod
    def of_solid(cls, solid: Solid) -> "_Piece":
        piece = cls(solid.name, solid.geometry())
        if solid.kind == "mesh":
            piece.inside, piece.triangles = solid.vertices[0], solid.vertices[solid.faces]
        return piece

    def near(self, T: Any, other: "_Piece", T_other: Any) -> bool:
        """Whether the balls around them meet."""
        gap = np.linalg.norm(T.transform(self.center) - T_other.transform(other.center))
        return bool(gap <= self.radius + other.radius)

    def meets(self, T: Any, other: "_Piece", T_other: Any) -> bool:
        """Whether surfaces meet."""
        return self.near(T, other, T_other) and touch(self.shape, T, other.shape, T_other)

    def one_holds_the_other(self, T: Any, solid: "_Piece", T_solid: Any) -> bool:
        """Whether a link's mesh goes round a solid or the other way."""
        if self.triangles is None or not self.near(T, solid, T_solid):
            return False
        within = T.inverse().transform(T_solid.transform(solid.inside))
        held = np.isfinite(solid.radius) and np.linalg.norm(within - self.center) < self.radius
        if held and is_inside(within, self.triangles):
            return True
        if solid.triangles is None:
            return False
        point = T_solid.inverse().transform(T.transform(self.triangles[0, 0]))
        return is_inside(point, solid.triangles)
