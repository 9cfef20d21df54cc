"""The improved model as texts that load where they are meant to, or not at all."""

from __future__ import annotations

from typing import Any

import mujoco
import pinocchio as pin

from pdoik.descriptions import quiet_mujoco

from ..model import Model
from ..simulation import read_description
from .export import export_mjcf, export_urdf


def improved_mjcf(model: Model) -> str:
    """Text of improved.xml, which MuJoCo loads.

    Raises:
        ValueError: it would not; the message says why.
    """
    text = export_mjcf(model).text
    _loaded("MuJoCo", mujoco.MjModel.from_xml_string, text)
    return text


def improved_urdf(model: Model) -> str | None:
    """Text of improved.urdf, which Pinocchio and, without shapes, MuJoCo load.

    None where the robot came as an MJCF.

    Raises:
        ValueError: it would not load; the message says why.
    """
    if model.robot is None or read_description(model.robot).format != "urdf":
        return None
    text = export_urdf(model).text
    _loaded("Pinocchio", pin.buildModelFromXML, text)
    _loaded("MuJoCo", lambda each: read_description(each).spec.compile(), text)
    return text


@quiet_mujoco()
def _loaded(where: str, load: Any, text: str) -> None:
    try:
        load(text)
    except Exception as error:
        raise ValueError(f"{where} would not load it: {error}") from error
