"""Whatever a robot is given as: its URDF, its joints and links, and its models."""

from __future__ import annotations

import difflib
import hashlib
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal
from xml.etree.ElementTree import Element

from .._addresses import Packages, Places, at_home, is_file, is_folder, with_paths
from .._cache import cache_folder
from .._core import Robot
from .._files import write_whole
from .._nearest import nearest
from ..errors import LoadError
from .installed import description_of, names
from .xml import FloatArray, tree_of

if TYPE_CHECKING:
    from .facts import RobotFacts

Kind = Literal["urdf", "xacro", "mjcf"]

_ROOT = re.compile(r"<\s*(mujoco|robot)\b")
_MACROS = re.compile(r"<\s*xacro:")


def urdf_text(
    robot: str | os.PathLike[str],
    *,
    arguments: Mapping[str, str] | None = None,
    packages: Packages = (),
    meshes: str | os.PathLike[str] | None = None,
) -> str:
    """A robot's URDF, its meshes named by absolute paths as far as they are found.

    Args:
        robot: A URDF, xacro or MJCF file, a shipped robot ("panda"), or the name of an installed
            description: `ur5`, `go2` (the package example-robot-data), `ur10e`,
            `panda_mj_description` (robot_descriptions), `unitree_g1` (mujoco-menagerie).
        arguments: Of a xacro file.
        packages: Folders by the name of the package, for `package://NAME/...` and `$(find NAME)`;
            or folders that hold packages. Those that are not here are looked for in the folders of
            PDOIK_PACKAGE_PATH, ROS_PACKAGE_PATH and AMENT_PREFIX_PATH, and above the file itself,
            by the name of their folder or that in their package.xml.
        meshes: Folder for the meshes of an MJCF, which its URDF names; without it, it has none.

    Raises:
        LoadError: There is no such file or description, or it cannot be read.
    """
    given = RobotDescription.of(robot, arguments=arguments, packages=packages)
    return given.urdf(None if meshes is None else Path(meshes))


def robot_file(path: Path) -> RobotDescription:
    """The description in a URDF, xacro or MJCF file; no names of installed ones.

    Raises:
        LoadError: No such file; the message says which is nearest.
    """
    if not path.is_file():
        near = [each.name for each in path.parent.iterdir()] if path.parent.is_dir() else []
        raise LoadError(f"robot: no such file: {path}{nearest(path.name, near)}")
    return RobotDescription.of_file(path)


def robot_facts(path: Path) -> RobotFacts:
    """Joints and links of such a file.

    Raises:
        LoadError: No such file, no XML, or no robot.
    """
    return robot_file(path).facts


def urdf_file(
    robot: str | os.PathLike[str],
    *,
    arguments: Mapping[str, str] | None = None,
    packages: Packages = (),
) -> Path:
    """A URDF of `urdf_text` as a file: the robot's own, or one in the user's cache with its meshes.

    Raises:
        LoadError: As there.
    """
    given = RobotDescription.of(robot, arguments=arguments, packages=packages)
    if given.kind == "urdf" and given.path is not None:
        return given.path
    source = f"{given.place}\n{sorted(given.arguments.items())}\n{given.text}"
    folder = cache_folder() / "urdf" / hashlib.sha256(source.encode()).hexdigest()[:16]
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / given.urdf_name
    write_whole(file, given.urdf(folder))
    return file


@dataclass(frozen=True, kw_only=True)
class RobotDescription:
    """A robot's description as it was found: all that reads a robot asks it.

    Attributes:
        path: Its file; None for text.
        text: What is in it.
        kind: As far as one look shows.
        arguments: Of a xacro file.
        packages: Where packages are, the folders around the file among them.
    """

    path: Path | None
    text: str
    kind: Kind
    arguments: Mapping[str, str] = field(default_factory=dict)
    packages: Places = field(default_factory=Places)

    @classmethod
    def of(
        cls,
        robot: str | os.PathLike[str],
        *,
        arguments: Mapping[str, str] | None = None,
        packages: Packages = (),
    ) -> RobotDescription:
        """Description of a file or a name.

        Raises:
            LoadError: There is none, or it cannot be read.
        """
        path = at_home(robot)
        if is_file(path):
            return cls.of_file(path, arguments=arguments, packages=packages)
        name = str(robot)
        if path.suffix or os.sep in name:
            raise LoadError(
                f"no such {'file, but a folder' if is_folder(path) else 'file'}: {path}"
            )
        return cls.of_name(name, arguments=arguments, packages=packages)

    @classmethod
    def of_file(
        cls,
        path: Path,
        *,
        arguments: Mapping[str, str] | None = None,
        packages: Packages = (),
    ) -> RobotDescription:
        """Description of a file.

        Raises:
            LoadError: It cannot be read, or takes no arguments.
        """
        try:
            text = path.read_bytes().decode("utf-8-sig", errors="replace")
        except (OSError, ValueError) as error:  # a NUL in the path is a ValueError
            reason = getattr(error, "strerror", None) or error
            raise LoadError(f"cannot read {path}: {reason}") from error
        kind = _kind(path, text)
        if arguments and kind != "xacro":
            raise LoadError(f"{path}: arguments are of xacro files, and this is none")
        return cls(
            path=path,
            text=text,
            kind=kind,
            arguments=arguments or {},
            packages=Places.of(packages, path),
        )

    @classmethod
    def of_name(
        cls,
        name: str,
        *,
        arguments: Mapping[str, str] | None = None,
        packages: Packages = (),
    ) -> RobotDescription:
        """Description of a shipped robot or an installed description.

        Raises:
            LoadError: There is none of that name, or its package cannot get it.
        """
        if (shipped := shipped_name(name)) is not None:
            file = Path(__file__).parents[1] / "robots" / f"{shipped}.urdf"
            return cls.of_file(file, arguments=arguments, packages=packages)
        found = description_of(name) or description_of(name.lower())
        if found is None:
            raise LoadError(_unknown(name))
        return cls.of_file(
            found.path,
            arguments={**found.arguments, **(arguments or {})},
            packages=Places.of(packages).before(found.packages),
        )

    @classmethod
    def of_text(cls, xml: str, *, packages: Packages = ()) -> RobotDescription:
        """Description of the text of a URDF or an MJCF."""
        return cls(path=None, text=xml, kind=_kind(None, xml), packages=Places.of(packages))

    @property
    def place(self) -> Path:
        """The file, or what stands for it in names."""
        return Path("text") if self.path is None else self.path.resolve()

    @property
    def urdf_name(self) -> str:
        """What a file of its URDF is called."""
        return f"{self.place.name.partition('.')[0]}.urdf"

    def urdf(self, meshes: Path | None = None) -> str:
        """The robot's URDF; meshes of an MJCF go into the folder, or are left out without one.

        Raises:
            LoadError: It cannot be read.
        """
        if self.path is not None and self.kind == "mjcf":
            from .mjcf import urdf_of_mjcf

            return urdf_of_mjcf(self.path, meshes)
        if self.path is not None and self.kind == "xacro":
            from .xacro_file import expanded

            return with_paths(expanded(self.path, self.arguments, self.packages), self.packages)
        return with_paths(self.text, self.packages)

    @cached_property
    def tree(self) -> Element:
        """XML tree: `<robot>` of a URDF or of what a xacro file stands for, `<mujoco>` of an MJCF.

        Raises:
            LoadError: It is no XML, or neither of the two.
        """
        of_file = self.path if self.kind != "xacro" else None
        root = tree_of(of_file or (self.text if self.kind == "mjcf" else self.urdf()))
        if root.tag not in ("robot", "mujoco"):
            raise LoadError(
                f"{self.place.name}: expected a URDF (<robot>) or MJCF (<mujoco>), got <{root.tag}>"
            )
        return root

    @cached_property
    def facts(self) -> RobotFacts:
        """Joints and links.

        Raises:
            LoadError: It cannot be read, or a number in it is none.
        """
        from .facts import facts_of_mjcf, facts_of_urdf

        if self.tree.tag == "mujoco":
            return facts_of_mjcf(self.path or self.place, self.mujoco)
        return facts_of_urdf(self.path or self.place, self.tree)

    @cached_property
    def mujoco(self) -> Any:
        """MuJoCo's model of an MJCF, shared by all who ask: it is not to be changed.

        Raises:
            LoadError: MuJoCo is not installed or refuses it.
        """
        from .mjcf import model_of_mjcf

        return model_of_mjcf(self.text if self.path is None else self.path)

    def pinocchio(self, *, floats: bool = False) -> Any:
        """Pinocchio's model, a new one.

        Args:
            floats: Joint 1 is then the base's six degrees of freedom: the MJCF's own free joint, or
                one that is put in front of a URDF.

        Raises:
            LoadError: Pinocchio refuses it, or it is the text of an MJCF, or one that cannot float.
        """
        import pinocchio as pin

        is_mjcf = self.tree.tag == "mujoco"
        if self.path is not None and self.kind != "xacro":
            read = pin.buildModelFromMJCF if is_mjcf else pin.buildModelFromUrdf
            source = str(self.path)
        elif is_mjcf:
            raise LoadError("Pinocchio reads an MJCF from a file, and this is text")
        else:
            read, source = pin.buildModelFromXML, self.urdf()
        try:
            floating = floats and not is_mjcf
            model = read(source, pin.JointModelFreeFlyer()) if floating else read(source)
        except (ValueError, RuntimeError) as error:
            raise LoadError(f"{self.place.name}: Pinocchio cannot read it: {error}") from error
        if floats and (model.njoints < 2 or model.joints[1].nv != 6):
            raise LoadError(
                f"{self.place.name}: its base floats; expected a <freejoint/> at its root"
            )
        return model

    def gravity_torque(self, joints: Sequence[str], q: FloatArray) -> FloatArray:
        """The torque that holds these joints still, by Pinocchio, or MuJoCo of an MJCF.

        Args:
            joints: Columns of q; the others stay where the description has them.
            q: (T, n) [rad].

        Returns:
            g(q), (T, n) [N m].

        Raises:
            LoadError: It cannot be read.
        """
        from .gravity import gravity_by_mujoco, gravity_by_pinocchio

        if self.tree.tag == "mujoco":
            return gravity_by_mujoco(self.mujoco, joints, q)
        return gravity_by_pinocchio(self.pinocchio(), joints, q)


def shipped_name(robot: str | os.PathLike[str]) -> str | None:
    """A shipped robot's name, in whatever case it is given; None of another."""
    name = str(robot).lower()
    return name if name in Robot.builtin_names() else None


def _kind(path: Path | None, text: str) -> Kind:
    root = _ROOT.search(text)
    if root is not None and root.group(1) == "mujoco":
        return "mjcf"
    suffix = "" if path is None else path.suffix
    return "xacro" if suffix == ".xacro" or _MACROS.search(text) else "urdf"


def _unknown(name: str) -> str:
    shipped, lower = Robot.builtin_names(), name.lower()
    known = [*dict.fromkeys([*shipped, *names()])]
    longer = [each for each in known if each.startswith(lower)]  # with a version, or of a variant
    near = longer[:5] or difflib.get_close_matches(lower, known, n=3, cutoff=0.5)
    said = f"; nearest: {', '.join(near)}" if near else ""
    return (
        f"no robot {name!r}: expected a file, one of {', '.join(shipped)}, or a description of"
        " example-robot-data, robot_descriptions or mujoco-menagerie, where they are installed"
        f"{said}"
    )
