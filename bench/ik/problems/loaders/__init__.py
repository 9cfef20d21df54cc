"""Published problem sets, read from the files that their authors give out.

A folder or file comes in, problems by the name of their set go out: MotionBenchMaker's folders of
MoveIt scenes and requests (or the archive of them), VAMP's problems.json or problems.pkl, EBIKE's
folder of scenarios.
"""

import tarfile
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from bench.ik.problems.loaders.ebike import read_ebike
from bench.ik.problems.loaders.moveit import read_moveit
from bench.ik.problems.loaders.vamp import read_vamp
from bench.ik.problems.problem import Problem
from bench.ik.problems.robots import RobotFiles
from pdoik.scenes import EntryError as LoaderError

ARCHIVES = (".tar", ".gz", ".bz2", ".xz", ".tgz")


def read_problems(
    path: Path, files: RobotFiles, joint_names: Sequence[str] | None = None
) -> dict[str, list[Problem]]:
    """The problems of a folder or file for a robot, by the name of their set.

    Known configurations are of `joint_names`, the joints that are moved, in this order; by default
    of all that the files do not hold.

    The path is a folder with scene0001.yaml and request0001.yaml, a folder of such folders, an
    archive of these; problems.json or problems.pkl; or a folder with *.pcd and *.ply.

    Raises:
        LoaderError: What cannot be read, by file and entry.
    """
    if not path.exists():
        raise LoaderError(path, "no such file or folder")
    if path.is_file():
        if path.suffix in (".json", ".pkl", ".pickle"):
            return read_vamp(path, files, joint_names)
        if path.suffix in ARCHIVES:
            return _read_archive(path, files, joint_names)
        raise LoaderError(path, f"expected .json, .pkl or an archive, got {path.suffix!r}")
    if any(path.glob("*.pcd")):
        return read_ebike(path, files)
    here = any(path.glob("scene*.y*ml"))
    folders = [path] if here else sorted(p for p in path.rglob("*") if p.is_dir())
    sets = {
        f.name: read_moveit(f, files, joint_names) for f in folders if any(f.glob("scene*.y*ml"))
    }
    if not sets:
        raise LoaderError(path, "neither scene*.yaml nor *.pcd in it or its folders")
    return sets


def _read_archive(
    path: Path, files: RobotFiles, joint_names: Sequence[str] | None
) -> dict[str, list[Problem]]:
    with TemporaryDirectory(prefix="pdoik-problems-") as folder:
        try:
            with tarfile.open(path) as archive:
                archive.extractall(folder, filter="data")
        except (tarfile.TarError, OSError) as error:
            raise LoaderError(path, f"not an archive that can be read: {error}") from error
        return read_problems(Path(folder), files, joint_names)


__all__ = ["LoaderError", "read_problems"]
