"""VAMP's problems.json and problems.pkl: the same problems, obstacles by kind."""

import json
import pickle
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.ik.problems.judge import Judge
from bench.ik.problems.problem import Problem
from bench.ik.problems.robots import RobotFiles
from bench.ik.problems.solids import Kind, Solid, SolidError, pose
from pdoik.scenes import EntryError as LoaderError
from pdoik.scenes import numbers, rotation

KINDS: tuple[Kind, ...] = ("sphere", "cylinder", "box", "capsule")
_HARMLESS = {
    "builtins": ("dict", "list"),
    "collections": ("defaultdict", "OrderedDict"),
    "numpy": ("dtype", "ndarray"),
    "numpy.core.multiarray": ("_reconstruct", "scalar"),
    "numpy._core.multiarray": ("_reconstruct", "scalar"),
}


class _Unpickler(pickle.Unpickler):
    """Makes containers and arrays only: a pickle from elsewhere may run nothing."""

    def find_class(self, module: str, name: str) -> Any:
        if name not in _HARMLESS.get(module, ()):
            raise pickle.UnpicklingError(f"holds a {module}.{name}")
        return super().find_class(module, name)


def read_vamp(
    path: Path, files: RobotFiles, joint_names: Sequence[str] | None = None
) -> dict[str, list[Problem]]:
    """Problems by the name of their set.

    A problem of several goals gives one problem for each. Those that VAMP itself calls invalid
    (`valid: false`) are read, too: the judge says what is valid by meshes.

    Raises:
        LoaderError: An entry cannot be read, or the file is for another robot.
    """
    content = _read(path)
    said = content.get("robot")
    if said is not None and said != files.name:
        raise LoaderError(path, f"is for {said!r}, not {files.name!r}", "robot")
    sets = content.get("problems", content)
    if not isinstance(sets, Mapping):
        raise LoaderError(path, "expected sets by name", "problems")
    judge = Judge(files, "collision", joint_names)
    joints = list(content.get("joints") or judge.joint_names)
    read = {
        str(name): [
            problem
            for k, entry in enumerate(entries)
            for problem in _problems(entry, f"{name}[{k}]", joints, path, judge)
        ]
        for name, entries in sets.items()
        if isinstance(entries, list)
    }
    if not read:
        raise LoaderError(path, "holds no list of problems", "problems")
    return read


def _read(path: Path) -> Mapping[str, Any]:
    try:
        if path.suffix == ".json":
            content = json.loads(path.read_text("utf-8"))
        else:
            with path.open("rb") as stream:
                content = _Unpickler(stream).load()
    except (OSError, ValueError, EOFError, pickle.UnpicklingError, ImportError) as error:
        raise LoaderError(path, f"cannot be read: {str(error)[:200]}") from error
    if not isinstance(content, Mapping):
        raise LoaderError(path, f"expected a mapping, got {type(content).__name__}")
    return content


def _problems(entry: Any, where: str, joints: list[str], path: Path, judge: Judge) -> list[Problem]:
    if not isinstance(entry, Mapping):
        raise LoaderError(path, f"expected a problem, got {entry!r}", where)
    solids = tuple(
        _solid(kind, item, k, path, f"{where}.{kind}[{k}]")
        for kind in KINDS
        for k, item in enumerate(entry.get(kind) or [])
    )
    goals = entry.get("goals")
    if goals is None:
        goals = [entry["goal"]] if "goal" in entry else []
    if not len(goals):
        raise LoaderError(path, "has no goals", where)
    index = entry.get("index", where.split("[")[-1].rstrip("]"))
    made = []
    for k, goal in enumerate(goals):
        q = _in_order(goal, joints, path, f"{where}.goals[{k}]", judge)
        suffix = f".{k}" if len(goals) > 1 else ""
        made.append(
            Problem(
                name=f"{entry.get('problem', where.split('[')[0])}/{index}{suffix}",
                robot=judge.files.name,
                solids=solids,
                targets={tip: judge.fk(q, tip) for tip in judge.files.tips},
                goal_q=q,
            )
        )
    return made


def _in_order(goal: Any, joints: list[str], path: Path, where: str, judge: Judge) -> FloatArray:
    if len(goal) != len(joints):
        raise LoaderError(path, f"{len(goal)} numbers for the joints {joints}", where)
    values = dict(zip(joints, goal, strict=True))
    if missing := [name for name in judge.joint_names if name not in values]:
        raise LoaderError(path, f"the robot's {missing} are not among {joints}", where)
    return np.array([float(values[name]) for name in judge.joint_names])


def _solid(kind: Kind, item: Mapping[str, Any], k: int, path: Path, where: str) -> Solid:
    T = pose(numbers(item.get("position"), "xyz", path, f"{where}.position"))
    if item.get("orientation_quat_xyzw") is not None:
        T[:3, :3] = rotation(item["orientation_quat_xyzw"], path, f"{where}.orientation_quat_xyzw")
    elif item.get("orientation_euler_xyz") is not None:
        angles = numbers(item["orientation_euler_xyz"], "xyz", path, f"{where}.orientation")
        T[:3, :3] = Rotation.from_euler("xyz", angles).as_matrix()  # about fixed axes
    if kind == "box":
        half = numbers(item.get("half_extents"), "xyz", path, f"{where}.half_extents")
        size = tuple(float(2 * edge) for edge in half)
    else:
        keys = ("radius",) if kind == "sphere" else ("radius", "length")
        size = tuple(
            float(numbers([item.get(key)], "r", path, f"{where}.{key}")[0]) for key in keys
        )
    name = str(item.get("name", f"{kind}_{k}")).strip()
    try:
        return Solid(name, kind, size, T)
    except SolidError as error:
        raise LoaderError(path, str(error), where) from error
