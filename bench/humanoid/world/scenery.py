"""Colours, lights, sky and floor: nothing here touches the dynamics."""

from __future__ import annotations

import mujoco

from pdoik.view.h1_shapes import SOLE_HALF_WIDTH, SOLE_HEEL, SOLE_HEIGHT, SOLE_TOE, Shape

_SHELL = (0.82, 0.83, 0.85, 1.0)
_DARK = (0.16, 0.17, 0.19, 1.0)
_DARK_LINKS = ("hip_yaw", "hip_roll", "shoulder_roll", "ankle")


def color_of(shape: Shape) -> tuple[float, float, float, float]:
    """Light shells on dark joints, dark feet, hands and face."""
    is_joint = any(part in shape.link for part in _DARK_LINKS)
    is_end = shape.kind == "sphere" or (shape.kind == "capsule" and shape.radius == 0.025)
    return _DARK if is_joint or is_end else _SHELL


def add_looks(spec: mujoco.MjSpec) -> None:
    """What rounds the robot off to the eye: knees, shoulders, soles. Nothing can touch these."""
    ball, plate = mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_BOX
    foot = (SOLE_HEEL + SOLE_TOE) / 2
    for side, y in (("left", 1.0), ("right", -1.0)):
        looks = (
            (f"{side}_knee_link", ball, (0.0, 0.0, 0.0), (0.042, 0.0, 0.0), _DARK),
            (f"{side}_ankle_link", ball, (0.0, 0.0, 0.0), (0.03, 0.0, 0.0), _DARK),
            (f"{side}_elbow_link", ball, (0.0, 0.0, 0.0), (0.034, 0.0, 0.0), _DARK),
            (f"{side}_shoulder_pitch_link", ball, (0.0, 0.05 * y, -0.016), (0.05, 0, 0), _DARK),
            (
                f"{side}_ankle_link",
                plate,
                (foot, 0.0, -SOLE_HEIGHT + 0.009),
                ((SOLE_TOE - SOLE_HEEL) / 2, SOLE_HALF_WIDTH, 0.009),
                _DARK,
            ),
        )
        for link, kind, center, size, color in looks:
            geom = spec.body(link).add_geom(type=kind, pos=center, size=size, rgba=color, group=2)
            geom.contype, geom.conaffinity = 0, 0


def add_scenery(spec: mujoco.MjSpec) -> None:
    """A chequered floor, a pale sky, two lights, and room for large pictures."""
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 1920, 1080
    spec.visual.headlight.ambient = [0.35, 0.35, 0.35]
    spec.visual.headlight.diffuse = [0.35, 0.35, 0.35]
    spec.visual.headlight.specular = [0.1, 0.1, 0.1]
    spec.visual.quality.shadowsize = 2048
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.93, 0.95, 0.97],
        rgb2=[0.70, 0.76, 0.83],
        width=256,
        height=256 * 6,
    )
    spec.add_texture(
        name="tiles",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=[0.62, 0.66, 0.70],
        rgb2=[0.55, 0.59, 0.63],
        width=300,
        height=300,
    )
    tiles = spec.add_material(name="tiles", texrepeat=[2, 2], texuniform=True, reflectance=0.0)
    tiles.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "tiles"
    spec.geom("floor").material = "tiles"
    for position, strength in (((1.5, -2.5, 4.0), 0.6), ((-2.5, -1.0, 3.5), 0.25)):
        light = spec.worldbody.add_light(pos=position, dir=[-part for part in position])
        light.type = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
        light.diffuse = [strength] * 3
        light.castshadow = strength > 0.5
