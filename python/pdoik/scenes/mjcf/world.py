"""MuJoCo's models as scenes: MuJoCo reads the file and places what is in it.

Obstacles are the geoms that can touch, of the world and of all bodies but the robot's, where they
stand in the model's own configuration or in a keyframe.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt

from pdoik.descriptions import model_of_mjcf
from pdoik.errors import ObstacleWarning
from pdoik.scenes.asked import Asked, World, check_names, some
from pdoik.scenes.contacts import rules_of_pairs
from pdoik.scenes.mjcf.bodies import own_bodies, with_all_below
from pdoik.scenes.mjcf.geoms import piece_of_geom
from pdoik.scenes.own_links import WORLD
from pdoik.scenes.pieces import Piece, Thing
from pdoik.scenes.values import EntryError

FloatArray = npt.NDArray[np.float64]


def read_mjcf(file: Path, asked: Asked) -> World:
    """The obstacles of a model.

    A shape is called as its geom is, or else as its body. Left out are the robot (`own_bodies`),
    geoms of which contype and conaffinity are 0, and what deforms. What MuJoCo lets touch may
    touch: pairs of bodies that the model excludes, and links that stand still with what does.

    Raises:
        LoadError: MuJoCo is not installed or refuses the file, or a name is none of its.

    Warns:
        ObstacleWarning: Bodies cannot be touched at all, or are driven though no robot is left out.
    """
    return _Reader(file, asked).world()


class _Reader:
    """Reader of one model."""

    def __init__(self, file: Path, asked: Asked) -> None:
        import mujoco

        self._mj, self._file, self._asked = mujoco, file, asked
        self._model = model_of_mjcf(file)
        self._state = mujoco.MjData(self._model)
        self._bodies = [self._name("BODY", b) or f"body{b}" for b in range(self._model.nbody)]
        if asked.keyframe is not None:
            number = self._keyframe(asked.keyframe)
            mujoco.mj_resetDataKeyframe(self._model, self._state, number)
        mujoco.mj_kinematics(self._model, self._state)

    def world(self) -> World:
        """All of it."""
        without = self._asked.without
        called = [self._called(g) for g in range(self._model.ngeom)]
        check_names(without, [*self._bodies[1:], *called], "body or geom", self._file)
        own = own_bodies(self._model, self._bodies, self._joint_names(), self._asked.own)
        unwanted = {b for b, name in enumerate(self._bodies) if b and name in without}
        out = own | with_all_below(self._model, unwanted)
        T_base_world = np.linalg.inv(self._base(own))
        pieces: dict[str, list[Piece]] = {}
        shape_bodies: dict[str, int] = {}
        untouchable: dict[int, list[str]] = {}
        for g in range(self._model.ngeom):
            body, name = int(self._model.geom_bodyid[g]), called[g]
            if body in out or name in without:
                continue
            entry = f"geom {self._name('GEOM', g) or g} of body {self._bodies[body]}"
            if not self._can_touch(g):
                untouchable.setdefault(body, []).append(name)
                continue
            T_world_geom = _pose(self._state.geom_xpos[g], self._state.geom_xmat[g])
            piece = self._piece(g, T_base_world @ T_world_geom, entry)
            mine = pieces.setdefault(name, [])
            shape_bodies[f"{name}/{len(mine)}" if mine else name] = body
            mine.append(piece)
        self._warn(own, out, untouchable, set(shape_bodies.values()))
        return World(
            things=tuple(Thing(name=n, pieces=tuple(each)) for n, each in pieces.items()),
            contacts=tuple(rules_of_pairs(self._allowed(own, shape_bodies), shape_bodies)),
            left_out=tuple(self._left_out(out, untouchable)),
        )

    def _called(self, g: int) -> str:
        """What a geom's shape is called."""
        body = int(self._model.geom_bodyid[g])
        return self._name("GEOM", g) or (self._bodies[body] if body else f"geom{g}")

    def _piece(self, g: int, T: FloatArray, entry: str) -> Piece:
        try:
            piece = piece_of_geom(self._model, g, T, entry)
        except ValueError as error:
            raise EntryError(self._file, str(error), entry) from error
        if piece is None:
            what = "is of a kind that is not read: leave its body out with without=[...]"
            raise EntryError(self._file, what, entry)
        return piece

    def _base(self, own: set[int]) -> FloatArray:
        """T_world_base, (4, 4)."""
        asked, model, state = self._asked, self._model, self._state
        name = asked.frame if asked.frame is not None else asked.own and asked.own.base_link
        if name is None or name == WORLD:
            return np.eye(4)
        if name in self._bodies:
            b = self._bodies.index(name)
            return _pose(state.xpos[b], state.xmat[b])
        sites = [self._name("SITE", s) for s in range(model.nsite)]
        if name in sites:
            s = sites.index(name)
            return _pose(state.site_xpos[s], state.site_xmat[s])
        if asked.frame is not None:
            known = some(self._bodies)
            raise EntryError(self._file, f"no body or site {name!r} for the base frame: {known}")
        if own:
            robot = some(self._bodies[b] for b in sorted(own))
            raise EntryError(
                self._file,
                f"has the robot ({robot}), but no body {name!r}, its base link: say which body's"
                " or site's frame that is, frame=NAME",
            )
        return np.eye(4)

    def _keyframe(self, keyframe: str | int) -> int:
        model = self._model
        names = [self._name("KEY", k) for k in range(model.nkey)]
        if isinstance(keyframe, str) and keyframe in names:
            return names.index(keyframe)
        if isinstance(keyframe, int) and 0 <= keyframe < model.nkey:
            return keyframe
        listed = some(name or str(k) for k, name in enumerate(names))
        raise EntryError(self._file, f"has no keyframe {keyframe!r}: {listed}")

    def _can_touch(self, g: int) -> bool:
        model = self._model
        paired = g in model.pair_geom1 or g in model.pair_geom2
        return bool(model.geom_contype[g] or model.geom_conaffinity[g] or paired)

    def _allowed(self, own: set[int], shape_bodies: dict[str, int]) -> Iterator[tuple[str, str]]:
        """What MuJoCo lets touch: (link, shape)."""
        model, robot = self._model, self._asked.own
        if robot is None:
            return
        excluded = {(int(both) >> 16, int(both) & 0xFFFF) for both in model.exclude_signature}
        for b in sorted(own):
            link = self._bodies[b]
            if link not in robot.moved | robot.still:
                continue
            stands = link in robot.still and model.body_weldid[b] == 0
            for shape, body in shape_bodies.items():
                both_stand = stands and model.body_weldid[body] == 0
                if both_stand or (b, body) in excluded or (body, b) in excluded:
                    yield link, shape

    def _warn(
        self, own: set[int], out: set[int], untouchable: dict[int, list[str]], touchable: set[int]
    ) -> None:
        seen_only = [
            *untouchable.get(0, []),
            *(self._bodies[b] for b in untouchable if b and b not in touchable),
        ]
        if seen_only:
            _warn(
                f"{self._file}: nothing can touch {some(seen_only)}, whose contype and conaffinity"
                " are 0: the robot will go through. Give them one that is not, or leave them"
                " out with without=[...]"
            )
        driven = sorted(self._driven() - out)
        if driven and not own:
            _warn(
                f"{self._file}: actuators move {some(self._bodies[b] for b in driven)}, which are"
                " taken as obstacles that stand still: if they are the robot, give robot=, whose"
                " links and joints are known by their names, or without=[...]"
            )
        if self._model.nflex:
            _warn(f"{self._file}: what deforms (flex) is left out: give its shape as a mesh")

    def _driven(self) -> set[int]:
        """Bodies whose joints have actuators."""
        model, kinds = self._model, self._mj.mjtTrn
        of_joints = (int(kinds.mjTRN_JOINT), int(kinds.mjTRN_JOINTINPARENT))
        return {
            int(model.jnt_bodyid[model.actuator_trnid[a][0]])
            for a in range(model.nu)
            if int(model.actuator_trntype[a]) in of_joints
        }

    def _left_out(self, out: set[int], untouchable: dict[int, list[str]]) -> Iterator[str]:
        yield from (f"body {self._bodies[b]}" for b in sorted(out))
        for names in untouchable.values():
            yield from (f"geom {name}, which nothing touches" for name in names)

    def _joint_names(self) -> list[str]:
        return [self._name("JOINT", j) for j in range(self._model.njnt)]

    def _name(self, kind: str, number: int) -> str:
        kinds = self._mj.mjtObj
        return str(self._mj.mj_id2name(self._model, getattr(kinds, f"mjOBJ_{kind}"), number) or "")


def _pose(position: FloatArray, matrix: FloatArray) -> FloatArray:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = matrix.reshape(3, 3), position
    return T


def _warn(what: str) -> None:
    warnings.warn(what, ObstacleWarning, stacklevel=2)
