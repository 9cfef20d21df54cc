"""Second implementations to judge pdoik by: Pinocchio, clearance and voxels in NumPy."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
import trimesh
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

import pdoik

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class PinocchioRobot:
    """Pinocchio's model of a URDF, from the URDF's own root. It knows nothing of mimic joints."""

    model: pin.Model
    data: pin.Data

    @classmethod
    def from_xml(cls, xml: str) -> "PinocchioRobot":
        model = pin.buildModelFromXML(xml)
        return cls(model=model, data=model.createData())

    @classmethod
    def floating(cls, xml: str) -> "PinocchioRobot":
        """With a free flyer for a root: without one Pinocchio leaves the root link's mass out."""
        model = pin.buildModelFromXML(xml, pin.JointModelFreeFlyer())
        return cls(model=model, data=model.createData())

    @property
    def joint_names(self) -> list[str]:
        return list(self.model.names)[1:]

    def frame(self, link: str) -> int:
        return int(self.model.getFrameId(link, pin.FrameType.BODY))

    def set(self, positions: dict[str, float]) -> None:
        q = pin.neutral(self.model)
        for name, value in positions.items():
            joint = self.model.joints[self.model.getJointId(name)]
            if joint.nq == 2:  # a continuous joint is a point of the circle there
                q[joint.idx_q : joint.idx_q + 2] = np.cos(value), np.sin(value)
            else:
                q[joint.idx_q] = value
        pin.computeJointJacobians(self.model, self.data, q)
        pin.updateFramePlacements(self.model, self.data)
        pin.jacobianCenterOfMass(self.model, self.data, q)

    def pose(self, base: str, link: str) -> Array:
        T_base, T_link = (self.data.oMf[self.frame(name)] for name in (base, link))
        return np.array((T_base.inverse() * T_link).homogeneous)

    def jacobian(self, base: str, link: str) -> dict[str, Array]:
        """Columns of the link's Jacobian as seen by someone who rides on `base`, by joint name."""
        world = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J_base, J_link = (
            pin.getFrameJacobian(self.model, self.data, self.frame(name), world).reshape(6, -1)
            for name in (base, link)
        )
        T_base, T_link = (self.data.oMf[self.frame(name)] for name in (base, link))
        R = T_base.rotation.T
        arm = T_link.translation - T_base.translation
        linear = R @ (J_link[:3] - J_base[:3] - np.cross(J_base[3:].T, arm).T)
        angular = R @ (J_link[3:] - J_base[3:])
        J = np.vstack([linear, angular])
        return {
            name: J[:, self.model.joints[i].idx_v] for i, name in enumerate(self.model.names) if i
        }

    def center_of_mass(self, base: str) -> Array:
        """In the frame of `base`, (3,). Of a floating model only."""
        T_base = self.data.oMf[self.frame(base)]
        return np.array(T_base.inverse().act(self.data.com[0]))

    def center_of_mass_jacobian(self, base: str) -> dict[str, Array]:
        """Its columns as seen by someone who rides on `base`, by joint name."""
        world = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J_base = pin.getFrameJacobian(self.model, self.data, self.frame(base), world)
        T_base = self.data.oMf[self.frame(base)]
        arm = self.data.com[0] - T_base.translation
        J = T_base.rotation.T @ (self.data.Jcom - J_base[:3] - np.cross(J_base[3:].T, arm).T)
        return {
            name: J[:, self.model.joints[i].idx_v]
            for i, name in enumerate(self.model.names)
            if i and self.model.joints[i].nv == 1
        }


def spheroid_distance(points: Array, f1: Array, f2: Array, semi_major: float) -> Array:
    """Distance from points (N, 3) to a prolate spheroid, negative inside, by a search."""
    axis = f2 - f1
    f = 0.5 * float(np.linalg.norm(axis))
    b = np.sqrt(semi_major**2 - f**2)
    axis = axis / (2 * f) if f > 0 else np.array([1.0, 0.0, 0.0])
    from_centre = points - 0.5 * (f1 + f2)
    along = from_centre @ axis
    radial = np.linalg.norm(from_centre - along[:, None] * axis, axis=1)

    def gap(t: Array) -> Array:
        return np.hypot(along[:, None] - semi_major * np.cos(t), radial[:, None] - b * np.sin(t))

    t = np.tile(np.linspace(0.0, np.pi, 721), (len(points), 1))
    for _ in range(6):  # each round looks 90 times closer
        best = np.take_along_axis(t, gap(t).argmin(axis=1)[:, None], axis=1)
        step = t[:, 1:2] - t[:, :1]
        t = best + step * np.linspace(-1.0, 1.0, 181)
    half_sum = 0.5 * sum(np.linalg.norm(points - f, axis=1) for f in (f1, f2))
    distance: Array = np.where(half_sum < semi_major, -1.0, 1.0) * gap(t).min(axis=1)
    return distance


def pieces_distance(points: Array, pieces: list[tuple[Array, Array]]) -> Array:
    """Of points to closed convex meshes, the nearest one, (N,), negative inside by its faces."""
    planes = [ConvexHull(vertices).equations for vertices, _ in pieces]
    above = np.array([(points @ p[:, :3].T + p[:, 3]).max(axis=1) for p in planes])
    least: Array = above.min(axis=0)
    for k in np.flatnonzero(least > 0.0):
        nearest = np.inf
        for piece in np.argsort(above[:, k]):
            if above[piece, k] >= nearest:
                break
            faces = pieces[piece][0][pieces[piece][1]]
            on = trimesh.triangles.closest_point(faces, np.broadcast_to(points[k], (len(faces), 3)))
            nearest = min(nearest, float(np.linalg.norm(on - points[k], axis=1).min()))
        least[k] = nearest
    return least


def clearance(
    occupancy: pdoik.Occupancy, poses: dict[str, Array], obstacles: Array, wanted: float = 0.0
) -> tuple[float, float]:
    """Least distance from an obstacle, less its radius, to a hull, at least and at most.

    A link that has capsules is what these fill; its other hulls do not count. Of what comes nearer
    to a capsule than is wanted, the link's own pieces say how near it is: for that capsule, or for
    the link's others too.

    Args:
        occupancy: The hulls.
        poses: Of links, in the base frame.
        obstacles: (N, 3) or (N, 4) [m].
        wanted: The clearance asked for [m].
    """
    if len(obstacles) == 0:
        return np.inf, np.inf

    def place(link: str, xyz: tuple[float, float, float]) -> Array:
        point: Array = poses[link][:3, :3] @ np.array(xyz) + poses[link][:3, 3]
        return point

    points = obstacles[:, :3]
    radii = obstacles[:, 3] if obstacles.shape[1] == 4 else np.zeros(len(obstacles))
    capsules: dict[str, list[Array]] = {}
    for link, xyz_a, xyz_b, radius, *_ in occupancy.capsules:
        a, along = place(link, xyz_a), place(link, xyz_b) - place(link, xyz_a)
        t = np.clip((points - a) @ along / max(float(along @ along), 1e-300), 0.0, 1.0)
        distances = np.linalg.norm(points - a - t[:, None] * along, axis=1) - radius - radii
        capsules.setdefault(link, []).append(distances)
    least, most = np.inf, np.inf
    of_links = [(link, np.array(v), np.array(t)) for link, v, t, _ in occupancy.pieces]
    for link, of_capsules in capsules.items():
        each = np.array(of_capsules)
        local = (points - poses[link][:3, 3]) @ poses[link][:3, :3]
        within = (each < wanted).any(axis=0)
        own = np.full(len(points), -np.inf)
        if within.any() and (pieces := [each[1:3] for each in of_links if each[0] == link]):
            own[within] = pieces_distance(local[within], pieces) - radii[within]
        least = min(least, float(np.where(each < wanted, np.maximum(each, own), each).min()))
        most = min(most, float(np.maximum(each.min(axis=0), own).min()))
    others = []
    for link, xyz, radius in occupancy.spheres:
        if link not in capsules:
            others.append(np.linalg.norm(points - place(link, xyz), axis=1) - radius)
    for link_a, xyz_a, link_b, xyz_b, semi_major in occupancy.spheroids:
        if not capsules.keys() & {link_a, link_b}:
            ends = place(link_a, xyz_a), place(link_b, xyz_b)
            others.append(spheroid_distance(points, *ends, semi_major))
    wide = min((float((distances - radii).min()) for distances in others), default=np.inf)
    return min(least, wide), min(most, wide)


def rotation_angle(R: Array) -> float:
    return float(np.linalg.norm(pin.log3(R)))


def voxel_means(points: Array, leaf: float) -> Array:
    """The mean of the points of each cell, sorted."""
    cells = np.floor(points / leaf).astype(np.int64)
    _, cell = np.unique(cells, axis=0, return_inverse=True)
    cell = cell.ravel()
    sums = np.zeros((cell.max() + 1, 3))
    np.add.at(sums, cell, points)
    means: Array = sums / np.bincount(cell)[:, None]
    return means
