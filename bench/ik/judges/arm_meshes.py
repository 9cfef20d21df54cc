"""The arms' collision meshes, from descriptions that others published, in our links' frames.

Panda and UR10 are those of the Python package example-robot-data, iiwa14 that of rtb-data. Links
are matched by name at q = 0: a link's frame may sit anywhere on the link, so the two frames differ
by a constant transform.
"""

import importlib.util
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pinocchio

from bench.common.arrays import FloatArray, moved
from bench.common.descriptions import MissingDescriptionError, example_robot_data
from bench.ik.experiment import Arm
from pdoik.occupancy_fit import load_geometry

UR = ("shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3")


@dataclass(frozen=True, slots=True, kw_only=True)
class PublicRobot:
    """Somebody else's description of a shipped robot, with collision meshes."""

    xml: str
    package_dirs: list[Path]
    links: dict[str, str]  # theirs -> ours, of every link with a mesh


def arm_meshes(arm: Arm) -> dict[str, FloatArray]:
    """Triangles of each link's collision meshes, (T, 3, 3) in our link's frame [m].

    Raises:
        MissingDescriptionError: The package is not installed.
        pdoik.LoadError: A mesh cannot be read.
    """
    with TemporaryDirectory() as folder:
        public = public_robot(arm.name, Path(folder))
        geometry = load_geometry(public.xml, public.package_dirs)
        theirs = pinocchio.buildModelFromXML(public.xml)
    triangles = {link.name: link.triangles for link in geometry}
    data, q = theirs.createData(), np.zeros(arm.robot.dof)
    pinocchio.framesForwardKinematics(theirs, data, np.zeros(theirs.nq))
    meshes = {}
    for their_link, our_link in public.links.items():
        T_base_theirs = data.oMf[theirs.getFrameId(their_link)].homogeneous
        T = np.linalg.inv(arm.robot.fk(q, our_link)) @ T_base_theirs
        meshes[our_link] = moved(triangles[their_link], T)
    return meshes


def public_robot(name: str, folder: Path) -> PublicRobot:
    """The published description of panda, ur10 or iiwa14.

    Some links to packages may be made in the folder, which must last as long as package_dirs do.

    Raises:
        MissingDescriptionError: The package is not installed.
    """
    if name == "iiwa14":
        root = _rtbdata() / "xacro/kuka_description/kuka_lbr_iiwa"
        package = folder / "kuka_lbr_iiwa_support"  # as its package:// addresses call it
        if not package.exists():
            package.symlink_to(root, target_is_directory=True)
        urdf, share = root / "urdf/lbr_iiwa_14_r820.urdf", folder
        links = {f"link_{i}": f"iiwa_link_{i}" for i in range(1, 8)} | {"base_link": "iiwa_link_0"}
    else:
        share = example_robot_data()
        urdf, links = {
            "panda": (
                "panda_description/urdf/panda.urdf",
                {f"panda_link{i}": f"panda_link{i}" for i in range(8)},
            ),
            # Frames of before 2020: axes along y, link frames at other places on the axes.
            "ur10": (
                "ur_description/urdf/ur10_robot.urdf",
                {"base_link": "base_link_inertia"} | {f"{n}_link": f"{n}_link" for n in UR},
            ),
        }[name]
        urdf = share / "example-robot-data/robots" / urdf
    return PublicRobot(xml=urdf.read_text("utf-8"), package_dirs=[share], links=links)


def _rtbdata() -> Path:
    spec = importlib.util.find_spec("rtbdata")
    if spec is None or not spec.submodule_search_locations:
        raise MissingDescriptionError("needs the Python package rtb-data")
    return Path(next(iter(spec.submodule_search_locations)))
