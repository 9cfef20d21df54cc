"""The study's `base:`, of a robot that nothing holds."""

from __future__ import annotations

from typing import Any

from scipy.spatial.transform import Rotation

from pdoik._nearest import nearest
from pdoik.descriptions import RobotFacts, pose_of, tree_of
from pdoik.errors import LoadError
from pdoik.recordings import Recording

from .floating_base import FloatingBase, Foot, Ground
from .key_tables import BASE, FOOT, GROUND, IMU
from .values import checked, number, shown, text, vector

_FLAT_FROM = 4  # numerics: joints of a leg that can turn a sole as well as place it

RECORD = (
    "record gyro.x gyro.y gyro.z [rad/s] and acc.x acc.y acc.z [m/s^2] of an IMU, or the base's"
    " pose base.x ... base.z base.qw ... base.qz"
)


def base_from(content: Any, facts: RobotFacts | None) -> FloatingBase | None:
    """The key's content; None where the study has none.

    Raises:
        LoadError: it is not as expected, or does not fit the robot.
    """
    if content is None:
        return None
    if facts is None:
        raise LoadError("base: expected a robot that it is the base of, 'robot:'")
    content = {} if content == "floating" else content
    keys = checked(content, BASE, "base")
    root = facts.root
    link = text(keys.get("link"), "base: link") or root
    if link != root:
        raise LoadError(f"base: link: expected {root!r}, the first of the robot's, got {link!r}")
    position, rotation = _imu(keys.get("imu"))
    return FloatingBase(
        link=root,
        imu_position=position,
        imu_rotation=rotation,
        feet=_feet(keys.get("feet"), facts),
        ground=_ground(keys.get("ground")),
    )


def check_base(base: FloatingBase | None, recording: Recording, held: bool) -> None:
    """Check that a recording shows how its base moved.

    Raises:
        LoadError: it does not; the message says what to record.
    """
    if base is None:
        if held:
            raise LoadError(f"{recording.name}: base: expected 'base:' in the study first")
        return
    imu = recording.gyro is not None and recording.acc is not None
    if not held and not imu and recording.base is None:
        half = recording.gyro is not None or recording.acc is not None
        raise LoadError(
            f"{recording.name}: the robot's base floats, but"
            f" {'only half of an IMU was recorded' if half else 'nothing tells how it moved'};"
            f" {RECORD}, or say 'base: held' in the recording's entry where a stand held it"
        )


def _imu(content: Any) -> tuple[Any, Any]:
    keys = checked({} if content is None else content, IMU, "base: imu")
    position = vector(keys.get("position", [0.0, 0.0, 0.0]), "base: imu: position", 3)
    rpy = vector(keys.get("rpy", [0.0, 0.0, 0.0]), "base: imu: rpy", 3)
    return position, Rotation.from_euler("xyz", rpy).as_matrix()


def _feet(content: Any, facts: RobotFacts) -> tuple[Foot, ...]:
    if content is None:
        return ()
    if isinstance(content, list):
        content = dict.fromkeys(map(str, content))
    if not isinstance(content, dict):
        raise LoadError(f"base: feet: expected a list of links, got {shown(content)}")
    return tuple(_foot(str(link), keys, facts) for link, keys in content.items())


def _foot(link: str, content: Any, facts: RobotFacts) -> Foot:
    source = f"base: feet: {link}"
    if link not in facts.masses:
        raise LoadError(
            f"base: feet: {facts.path.name} has no link {link!r}{nearest(link, facts.masses)}"
        )
    keys = checked({} if content is None else content, FOOT, source)
    kind = keys.get("contact")
    if kind not in (None, "point", "flat"):
        raise LoadError(f"{source}: contact: expected point or flat, got {shown(kind)}")
    chain = facts.chain(link)
    moved = sum(joint.link in chain for joint in facts.joints.values())
    flat = moved >= _FLAT_FROM if kind is None else kind == "flat"
    at, sole = (None, None) if flat else _ball(facts, link)
    if keys.get("sole") is not None:
        sole = number(keys["sole"], f"{source}: sole", least=0.0)
    return Foot(link=link, flat=flat, at=at or (0.0, 0.0, 0.0), sole=sole)


def _ball(facts: RobotFacts, link: str) -> tuple[tuple[float, float, float] | None, float | None]:
    """Middle in the link's frame and radius [m] of a foot that is a ball in a URDF."""
    for each in tree_of(facts.path).findall(f"link[@name='{link}']/collision"):
        ball = each.find("geometry/sphere")
        if ball is not None:
            x, y, z = pose_of(each)[:3, 3].tolist()
            return (x, y, z), float(ball.get("radius", "nan"))
    return None, None


def _ground(content: Any) -> Ground:
    keys = checked({} if content is None else content, GROUND, "base: ground")
    friction = keys.get("friction")
    return Ground(
        friction=None if friction is None else number(friction, "base: ground: friction", least=0),
        height=number(keys.get("height", 0.0), "base: ground: height"),
    )
