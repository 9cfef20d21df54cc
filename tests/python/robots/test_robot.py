"""What a robot says of itself, and what it refuses to be."""

import copy
import pickle
import warnings
from pathlib import Path

import numpy as np
import pytest

import pdoik
from conftest import ROBOTS, SHIPPED
from random_urdf import random_urdf

LINKS = '<link name="a"/><link name="b"/><link name="c"/>'
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


def joint(name: str, parent: str, child: str, *, kind: str = "revolute", extra: str = LIMIT) -> str:
    links = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{links}{extra}</joint>'


def urdf(*parts: str) -> str:
    return f'<robot name="r">{"".join(parts)}</robot>'


CHAIN = urdf(LINKS, joint("j1", "a", "b"), joint("j2", "b", "c"))


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_robots_load_without_a_warning(name: str) -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        robot = pdoik.Robot.builtin(name)
    assert [str(each.message) for each in caught] == robot.warnings == []
    assert name in pdoik.Robot.builtin_names()
    assert robot.name == name
    assert robot.dof == len(robot.joint_names) == len(robot.joint_types) == len(robot.lower)
    assert len(robot.link_masses) == len(robot.link_centers_of_mass) == len(robot.link_names)


@pytest.mark.parametrize("name", SHIPPED)
def test_a_file_a_path_and_its_text_give_the_same_robot(name: str) -> None:
    path = ROBOTS / f"{name}.urdf"
    q = pdoik.Robot.builtin(name).mid_configuration()
    poses = [pdoik.Robot.from_urdf(each).fk(q) for each in (path, str(path), path.read_text())]
    for pose in poses:
        np.testing.assert_array_equal(pose, pdoik.Robot.builtin(name).fk(q))


def test_masses_are_those_of_the_file() -> None:
    text = (
        '<link name="x"><inertial><origin xyz="1 2 3"/><mass value="4"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )
    robot = pdoik.Robot.from_urdf(urdf(text, '<link name="y"/>', joint("j", "x", "y")))
    by_name = dict(zip(robot.link_names, robot.link_masses, strict=True))
    assert by_name == {"x": 4.0, "y": 0.0}
    np.testing.assert_array_equal(
        robot.link_centers_of_mass[robot.link_names.index("x")], [1, 2, 3]
    )


def test_joint_types_and_limits_come_through() -> None:
    speed = '<limit effort="1" velocity="2.5"/>'
    robot = pdoik.Robot.from_urdf(
        urdf(
            LINKS,
            '<link name="d"/>',
            joint("j1", "a", "b", kind="continuous", extra=speed),
            joint("j2", "b", "c", kind="prismatic", extra=LIMIT),
            joint("j3", "c", "d", kind="fixed", extra=""),
        )
    )
    assert robot.joint_types == ["continuous", "prismatic"]
    np.testing.assert_array_equal(robot.lower, [-np.inf, -1.0])
    np.testing.assert_array_equal(robot.upper, [np.inf, 1.0])
    np.testing.assert_array_equal(robot.velocity, [2.5, 1.0])
    np.testing.assert_array_equal(robot.mid_configuration(), [0.0, 0.0])


def test_tips_may_be_none_one_or_several() -> None:
    text = urdf(LINKS, joint("j1", "a", "b"), joint("j2", "a", "c"))
    assert pdoik.Robot.from_urdf(text).tip_links == ["b", "c"]
    assert pdoik.Robot.from_urdf(text, tip_link="c").tip_links == ["c"]
    robot = pdoik.Robot.from_urdf(text, tip_link=["c", "a"])
    assert robot.tip_links == ["c", "a"]
    with pytest.raises(ValueError, match=r"2 tips: .*c.*a"):
        robot.fk([0, 0])
    with pytest.raises(ValueError, match=r"one target, but the robot has 2 tips.*c.*a"):
        pdoik.Solver(robot).solve(np.eye(4))


AB, BC = joint("j1", "a", "b"), joint("j2", "b", "c")
NO_TREES = {
    "no links": (urdf(), "No link elements"),
    "an orphan": (urdf(LINKS, AB), "root link"),
    "two parents": (
        urdf(LINKS, AB, joint("j2", "a", "c"), joint("j3", "b", "c")),
        "'c' has two parents",
    ),
    "a loop": (urdf(LINKS, AB, joint("j2", "b", "a"), joint("j3", "b", "c")), "No root link"),
    "a loop apart": (urdf(LINKS, joint("j1", "b", "c"), joint("j2", "c", "b")), "b, c form a loop"),
    "a link joined to itself": (
        urdf(LINKS, AB, joint("j2", "c", "c")),
        "'j2' joins link 'c' to",
    ),
    "no such child": (urdf(LINKS, AB, joint("j2", "b", "z")), r"\[z\] of joint \[j2\]"),
    "two joints of one name": (urdf(LINKS, AB, joint("j1", "b", "c")), "'j1' is not unique"),
    "two links of one name": (urdf(LINKS, LINKS, AB, BC), "'a' is not unique"),
    "an axis of no length": (
        urdf(LINKS, AB, joint("j2", "b", "c", extra='<axis xyz="0 0 0"/>' + LIMIT)),
        "'j2': axis has length 0",
    ),
    "limits out of order": (
        urdf(LINKS, AB, joint("j2", "b", "c", extra=LIMIT.replace('lower="-1"', 'lower="2"'))),
        "'j2': lower limit 2.* is above its upper limit 1",
    ),
    "no limits": (
        urdf(LINKS, AB, joint("j2", "b", "c", extra="")),
        "not specify limits",
    ),
    "planar": (urdf(LINKS, AB, joint("j2", "b", "c", kind="planar")), "'j2' is of a type"),
    "floating": (urdf(LINKS, AB, joint("j2", "b", "c", kind="floating")), "'j2' is of a type"),
    "mimics nothing": (
        urdf(LINKS, AB, joint("j2", "b", "c", extra='<mimic joint="z"/>' + LIMIT)),
        "'j2' mimics 'z'",
    ),
    "mimics in a circle": (
        urdf(
            LINKS,
            joint("j1", "a", "b", extra='<mimic joint="j2"/>' + LIMIT),
            joint("j2", "b", "c", extra='<mimic joint="j1"/>' + LIMIT),
        ),
        "mimics itself in a circle",
    ),
}


@pytest.mark.parametrize(("text", "message"), NO_TREES.values(), ids=NO_TREES.keys())
def test_what_is_no_tree_of_joints_is_refused_by_name(text: str, message: str) -> None:
    with pytest.raises(pdoik.LoadError, match=message):
        pdoik.Robot.from_urdf(text)


def test_links_that_are_not_there_are_named_with_those_that_are() -> None:
    with pytest.raises(pdoik.LoadError, match=r"base link 'z'.*a, b, c"):
        pdoik.Robot.from_urdf(CHAIN, base_link="z")
    with pytest.raises(pdoik.LoadError, match=r"tip link 'z'.*a, b, c"):
        pdoik.Robot.from_urdf(CHAIN, tip_link="z")
    with pytest.raises(ValueError, match=r"link 'z'.*a, b, c"):
        pdoik.Robot.from_urdf(CHAIN).fk([0, 0], "z")
    with pytest.raises(ValueError, match=r"'z', expected one of .*panda"):
        pdoik.Robot.builtin("z")


def test_unreadable_files_are_load_errors(tmp_path: Path) -> None:
    for path in (tmp_path / "none.urdf", tmp_path, ""):
        with pytest.raises(pdoik.LoadError):
            pdoik.Robot.from_urdf(path)


def test_a_file_that_is_not_utf_8_is_a_load_error(tmp_path: Path) -> None:
    path = tmp_path / "latin.urdf"
    path.write_bytes(urdf('<link name="\xe9"/>').encode("latin-1"))
    with pytest.raises(pdoik.LoadError):
        pdoik.Robot.from_urdf(path)


def test_a_path_is_not_cut_at_a_nul() -> None:
    for load, path in (
        (pdoik.Robot.from_urdf, ROBOTS / "panda.urdf"),
        (pdoik.Occupancy.load, ROBOTS / "panda.occupancy.yaml"),
    ):
        with pytest.raises(pdoik.LoadError):
            load(f"{path}\0.urdf")


@pytest.mark.parametrize(
    "inertial",
    [
        '<mass value="-1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>',
        '<mass value="1"/><inertia ixx="-1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>',
        '<mass value="1"/><inertia ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"/>',
        '<mass value="0"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>',
    ],
    ids=["negative mass", "negative moment", "triangle inequality", "inertia without mass"],
)
def test_impossible_inertias_warn_and_leave_kinematics_alone(inertial: str) -> None:
    odd = CHAIN.replace(
        '<link name="b"/>', f'<link name="b"><inertial>{inertial}</inertial></link>'
    )
    with pytest.warns(pdoik.RobotWarning, match="link 'b'"):
        robot = pdoik.Robot.from_urdf(odd)
    assert len(robot.warnings) == 1
    sound = pdoik.Robot.from_urdf(CHAIN)
    np.testing.assert_array_equal(robot.fk([0.3, 0.4]), sound.fk([0.3, 0.4]))


def test_warnings_as_errors_come_out_as_exceptions() -> None:
    odd = CHAIN.replace('name="b"/>', 'name="b"><inertial><mass value="-1"/></inertial></link>', 1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises((pdoik.RobotWarning, pdoik.LoadError)):
            pdoik.Robot.from_urdf(odd)


HULLS = pdoik.Occupancy(
    spheres=[("a", (0.1, 0.2, 0.3), 0.4)],
    spheroids=[("a", (0.0, 0.0, 0.0), "c", (1 / 3, 0.0, 0.1), 0.7)],
)


def test_an_occupancy_gives_back_what_it_was_given() -> None:
    assert HULLS.spheres == [("a", (0.1, 0.2, 0.3), 0.4)]
    assert HULLS.spheroids == [("a", (0.0, 0.0, 0.0), "c", (1 / 3, 0.0, 0.1), 0.7)]
    assert len(HULLS) == 2
    array = pdoik.Occupancy(
        spheres=[("a", np.array([0.1, 0.2, 0.3]), np.float64(0.4))], spheroids=HULLS.spheroids
    )
    assert array == HULLS
    assert hash(array) == hash(HULLS)
    assert pdoik.Occupancy(spheres=HULLS.spheres) != HULLS
    assert HULLS != "hulls"
    assert "1 spheres, 1 spheroids, 0 capsules and 0 pieces" in repr(HULLS)
    capsule = ("c", (0.0, 0.1, 0.0), (0.0, 0.2, 1 / 3), 0.05)
    closer = pdoik.Occupancy(spheres=HULLS.spheres, spheroids=HULLS.spheroids, capsules=[capsule])
    assert closer.capsules == [(*capsule, 0.0)]
    tight = pdoik.Occupancy(capsules=[(*capsule, 0.004)])
    assert tight.capsules == [(*capsule, 0.004)]
    assert pdoik.Occupancy.load(tight.to_yaml()) == tight != pdoik.Occupancy(capsules=[capsule])
    assert pickle.loads(pickle.dumps(tight)) == tight
    assert closer != HULLS
    assert pickle.loads(pickle.dumps(closer)) == closer
    assert pdoik.Occupancy.load(closer.to_yaml()) == closer


def test_a_robot_takes_an_occupancy_and_keeps_a_copy() -> None:
    robot = pdoik.Robot.from_urdf(CHAIN)
    assert robot.occupancy == pdoik.Occupancy()
    other = copy.copy(robot)
    robot.occupancy = HULLS
    assert robot.occupancy == copy.deepcopy(robot).occupancy == HULLS
    assert other.occupancy == pdoik.Occupancy()


@pytest.mark.parametrize(
    ("hulls", "message"),
    [
        ({"spheres": [("z", (0, 0, 0), 1)]}, "link 'z'"),
        ({"spheres": [("a", (0, 0, 0), 0)]}, r"spheres\[0\].*radius is 0"),
        ({"spheres": [("a", (0, 0, 0), 1), ("a", (0, 0, 0), np.nan)]}, r"spheres\[1\].*radius"),
        ({"spheres": [("a", (0, 0, 0), np.inf)]}, "radius"),
        ({"spheres": [("a", (0, np.nan, 0), 1)]}, "xyz"),
        ({"spheres": [("a", (0, 0), 1)]}, r"xyz has shape \(2,\), expected \(3,\)"),
        ({"spheroids": [("a", (0, 0, 0), "z", (0, 0, 0), 1)]}, "link 'z'"),
        ({"spheroids": [("a", (0, 0, 0), "b", (0, 0, np.inf), 1)]}, "xyz_b"),
        ({"spheroids": [("a", (0, 0, 0), "a", (0, 0, 1), 0.5)]}, "semi_major is 0.5.*half"),
        ({"spheroids": [("a", (0, 0, 0), "b", (0, 0, 1), -1)]}, "semi_major is -1"),
    ],
)
def test_hulls_that_are_none_are_refused_by_name(hulls: dict[str, list], message: str) -> None:
    robot = pdoik.Robot.from_urdf(CHAIN)
    robot.occupancy = HULLS
    with pytest.raises(ValueError, match=message):
        robot.occupancy = pdoik.Occupancy(**hulls)
    assert robot.occupancy == HULLS


def test_an_occupancy_survives_its_file(tmp_path: Path) -> None:
    path = tmp_path / "a.occupancy.yaml"
    path.write_text("old")
    HULLS.save(path)
    assert pdoik.Occupancy.load(path) == pdoik.Occupancy.load(HULLS.to_yaml()) == HULLS
    assert [each.name for each in tmp_path.iterdir()] == [path.name]
    with pytest.raises(FileNotFoundError):
        HULLS.save(tmp_path / "none" / "a.yaml")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("spheres: 3", "spheres"),
        ("balls: []", "balls"),
        ("spheres: [{link: a, center: [0, 0], radius: 1}]", r"spheres\[0\].*center"),
        ("spheres: [{link: a, center: [0, 0, x], radius: 1}]", r"spheres\[0\].*center"),
        ("spheres: [{link: a, center: [0, 0, 0]}]", r"spheres\[0\].*radius"),
        ("spheroids: [{link_a: a}]", r"spheroids\[0\]"),
        ("a: [", "YAML"),
        ("- 1\n", "mapping"),
    ],
)
def test_a_bad_occupancy_file_is_a_load_error_that_names_the_entry(text: str, message: str) -> None:
    with pytest.raises(pdoik.LoadError, match=message):
        pdoik.Occupancy.load(text)


@pytest.mark.parametrize("seed", range(5))
def test_links_keep_their_places_whatever_the_order_in_the_file(
    seed: int, rng: np.random.Generator
) -> None:
    text = random_urdf(rng, links=7).xml
    head, *lines = text.splitlines()[1:-1]
    shuffled = "\n".join([head, *rng.permutation(lines), "</robot>"])
    robot, other = pdoik.Robot.from_urdf(text), pdoik.Robot.from_urdf(shuffled)
    assert (robot.joint_names, robot.link_names) == (other.joint_names, other.link_names)
