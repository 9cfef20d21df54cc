"""The hulls of a benchmark's robot, fitted once and kept in build/."""

import hashlib
from dataclasses import replace
from pathlib import Path

import pdoik
from bench.common.peer_library import ROOT
from bench.common.whole_files import write_text
from bench.ik.problems.robots import Meshes, RobotFiles
from pdoik.occupancy_fit import fit_occupancy

KEPT = ROOT / "build/bench/problems/hulls"
FACTOR, PARTS = 2.0, 4  # max_volume_factor and max_parts of the fit


def fitted_robot(files: RobotFiles, meshes: Meshes = "collision", kept: Path = KEPT) -> pdoik.Robot:
    """The robot with hulls that hold its meshes.

    The SRDF's pairs are ignored between hulls, and so are pairs of hulls that always touch. Hulls
    are in their links' frames: where joints are set to stand does not change them.

    Raises:
        pdoik.LoadError: The description or a mesh cannot be read.
    """
    xml = replace(files, told={}).xml(meshes)
    robot = pdoik.Robot.from_urdf(files.xml(), files.base, list(files.tips))
    key = hashlib.sha256(f"{xml} {FACTOR} {PARTS}".encode()).hexdigest()[:16]
    file = kept / f"{files.name}-{key}.yaml"
    if not file.is_file():
        # What stands on a foot has links above its base, which the description hangs it below.
        base = files.base if len(files.tips) == 1 else None
        fit = fit_occupancy(xml, files.package_dirs, FACTOR, base, max_parts=PARTS)
        kept.mkdir(parents=True, exist_ok=True)
        write_text(file, fit.to_yaml(f"{files.name}: {meshes} meshes, factor {FACTOR:g}"))
    robot.occupancy = pdoik.Occupancy.load(file)
    pairs = set(pdoik.pairs_always_touching(robot))
    if files.srdf is not None:
        pairs |= set(pdoik.load_srdf_pairs(files.srdf, robot))
    robot.ignored_pairs = sorted(pairs)
    return robot
