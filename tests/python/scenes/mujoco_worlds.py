"""An arm of capsules among all kinds of geoms, as MJCF: MuJoCo and pdoik have the same solids."""

from __future__ import annotations

from pathlib import Path

import coal
import mujoco
import numpy as np

import pdoik

ARM = """
    <body name="base" pos="0.1 -0.2 0.3" euler="0 0 40">
      <geom name="foot" type="cylinder" size="0.08 0.1" pos="0 0 -0.12"/>
      <body name="turret" pos="0 0 0.1">
        <joint name="j1" axis="0 0 1" range="-170 170"/>
        <geom name="g1" type="capsule" fromto="0 0 0.02 0 0 0.2" size="0.05"/>
        <body name="upper" pos="0 0 0.25">
          <joint name="j2" axis="0 1 0" range="-110 110"/>
          <geom name="g2" type="capsule" fromto="0 0 0 0 0 0.4" size="0.045"/>
          <body name="elbow" pos="0 0 0.45">
            <joint name="j3" axis="0 1 0" range="-140 140"/>
            <geom name="g3" type="capsule" fromto="0 0 0 0 0 0.15" size="0.04"/>
            <body name="fore" pos="0 0 0.15">
              <joint name="j4" axis="0 0 1" range="-170 170"/>
              <geom name="g4" type="capsule" fromto="0 0 0.05 0 0 0.2" size="0.035"/>
              <body name="wrist" pos="0 0 0.25">
                <joint name="j5" axis="0 1 0" range="-120 120"/>
                <geom name="g5" type="capsule" fromto="0 0 0 0 0 0.08" size="0.03"/>
                <body name="hand" pos="0 0 0.1">
                  <joint name="j6" axis="0 0 1" range="-170 170"/>
                  <geom name="g6" type="capsule" fromto="0 -0.05 0.04 0 0.05 0.04" size="0.02"/>
                  <site name="tip" pos="0 0 0.1"/>
                </body>
              </body>
            </body>
          </body>
        </body>
      </body>
    </body>
"""
LINKS = ("turret", "upper", "elbow", "fore", "wrist", "hand")

WORLD = """
    <geom name="floor" type="plane" size="1 1 0.1" euler="3 -2 0"/>
    <geom type="box" size="0.1 0.2 0.3" pos="0.8 0.3 0.3" euler="10 20 30"/>
    <body name="table" pos="-0.5 0.4 0.2" euler="0 0 25">
      <geom type="box" size="0.3 0.4 0.02" pos="0 0 0.2"/>
      <geom type="cylinder" size="0.03 0.1" pos="0.1 0 0.1"/>
      <geom name="pot" type="ellipsoid" size="0.1 0.15 0.08" pos="0 0.1 0.32"/>
      <geom name="drawn" type="box" size="0.5 0.5 0.5" contype="0" conaffinity="0"/>
    </body>
    <body name="ball" pos="0.3 -0.7 0.8">
      <freejoint/>
      <geom type="sphere" size="0.12"/>
    </body>
    <body name="door" pos="0.7 -0.5 0.5">
      <joint name="hinge" axis="0 0 1"/>
      <geom type="box" size="0.2 0.01 0.4" pos="0.2 0 0"/>
      <geom type="capsule" fromto="0.3 0.05 0 0.3 0.05 0.15" size="0.015"/>
    </body>
    <body name="rock" pos="-0.4 -0.6 0.6" euler="40 10 70">
      <geom type="mesh" mesh="rock"/>
    </body>
"""

ASSETS = """
  <asset><mesh name="rock" vertex="{rock}"/></asset>
"""


def written(folder: Path, world: str = WORLD, *, arm: str = ARM, more: str = "") -> Path:
    """A model of the arm in a world."""
    corners = np.random.default_rng(3).uniform(-0.2, 0.2, (14, 3))
    assets = ASSETS.format(rock=" ".join(f"{value:.6f}" for value in corners.ravel()))
    path = folder / "world.xml"
    path.write_text(
        f'<mujoco model="cell">{assets}<worldbody>{arm}{world}</worldbody>{more}</mujoco>'
    )
    return path


def arm_of(path: Path, base_link: str | None = "base") -> pdoik.Robot:
    """The arm of such a model, read alone from beside it; its hulls are MuJoCo's capsules."""
    alone = path.with_name("arm.xml")
    alone.write_text(f'<mujoco model="arm"><worldbody>{ARM}</worldbody></mujoco>')
    robot = pdoik.Robot.from_mjcf(alone, base_link=base_link, tip_link="tip")
    model = mujoco.MjModel.from_xml_path(str(alone))
    capsules = []
    for link in LINKS:
        body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, link)
        (g,) = np.flatnonzero(model.geom_bodyid == body)
        R = np.zeros(9)
        mujoco.mju_quat2Mat(R, model.geom_quat[g])
        along = model.geom_size[g][1] * R.reshape(3, 3)[:, 2]
        ends = (model.geom_pos[g] - along, model.geom_pos[g] + along)
        capsules.append((link, *map(tuple, ends), float(model.geom_size[g][0])))
    robot.occupancy = pdoik.Occupancy(capsules=capsules)
    return robot


class Truth:
    """MuJoCo's account of the arm in a world."""

    def __init__(self, path: Path, keyframe: int | None = None) -> None:
        self.model = mujoco.MjModel.from_xml_path(str(path))
        self.state = mujoco.MjData(self.model)
        if keyframe is not None:
            mujoco.mj_resetDataKeyframe(self.model, self.state, keyframe)
        bodies = [mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, name) for name in LINKS]
        self.arm = np.flatnonzero(np.isin(self.model.geom_bodyid, bodies))
        foot = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_GEOM, "foot")
        self.own = {*self.arm.tolist(), foot}

    def move(self, robot: pdoik.Robot, q: np.ndarray) -> None:
        for name, value in zip(robot.joint_names, q, strict=True):
            j = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, name)
            self.state.qpos[self.model.jnt_qposadr[j]] = value
        mujoco.mj_forward(self.model, self.state)

    def distance(self, g: int) -> float:
        """Of geom g to the arm [m]."""
        return min(
            mujoco.mj_geomDistance(self.model, self.state, int(a), g, 5.0, None) for a in self.arm
        )

    def pierces(self, g: int) -> bool:
        """Whether the arm is in a box by coal: MuJoCo sees no capsule that goes right through."""
        assert self.model.geom_type[g] == mujoco.mjtGeom.mjGEOM_BOX
        size, request, result = (
            self.model.geom_size,
            coal.CollisionRequest(),
            coal.CollisionResult(),
        )
        for a in self.arm:
            capsule, box = coal.Capsule(size[a][0], 2 * size[a][1]), coal.Box(*(2 * size[g]))
            coal.collide(capsule, self._pose(int(a)), box, self._pose(g), request, result)
        return bool(result.isCollision())

    def _pose(self, g: int) -> coal.Transform3s:
        return coal.Transform3s(self.state.geom_xmat[g].reshape(3, 3), self.state.geom_xpos[g])

    def touches(self) -> list[str]:
        """What the arm is in contact with, by geom."""
        found = []
        for contact in self.state.contact[: self.state.ncon]:
            mine = [int(g) in self.own for g in contact.geom]
            if sum(mine) == 1 and contact.dist < 0:
                g = int(contact.geom[mine.index(False)])
                found.append(
                    mujoco.mj_id2name(self.model, mujoco.mjtObj.mjOBJ_GEOM, g) or f"geom {g}"
                )
        return found
