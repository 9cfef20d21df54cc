"""Every key that a study may have. Readers take no other; `pdoik study keys` prints them."""

from __future__ import annotations

from pdoik.recordings import MAX_ROWS, Key, Keys, entry_keys

_NONE = "none"
_PER_JOINT = "a list in the joints' order, or by name"

STUDY: Keys = {
    "robot": Key(
        "a path", "URDF or MJCF of the machine", "arm.urdf", "no description: less can be found"
    ),
    "base": Key("`floating`, or a mapping", "a base that is not fixed", "floating", "fixed"),
    "tip": Key("a link", "the link whose pose is `tip.x` ... `tip.qw`", "tool", "the last link"),
    "joints": Key(
        "a list of names",
        "the joints to diagnose, in this order",
        "[j1, j2]",
        "all that have a position",
    ),
    "recordings": Key(
        "a list of paths or mappings",
        "logs of the machine",
        "[run1.csv, {file: run2.csv, role: validate}]",
    ),
    "controller": Key(
        "a mapping",
        "what is known of the control law",
        "{type: pd, kp: [300, 300], kd: [20, 20]}",
        "not known",
    ),
    "simulation": Key(
        "a list as `recordings`",
        "logs of your simulator under the same commands",
        "[sim1.csv]",
        _NONE,
    ),
    "simulator": Key(
        "a mapping", "your simulator's model, which `pdoik compare` runs", "{mjcf: go2.xml}", _NONE
    ),
    "trust": Key(
        "a mapping",
        "how large errors of model and torques may be",
        "{rigid_body: 0.05}",
        "see below",
    ),
    "rotor_inertia": Key(
        _PER_JOINT, "of each drive's rotor, seen at the joint [kg m^2]", "[0.05, 0.02]", "fitted"
    ),
    "units": Key(
        "a mapping",
        "unit of a channel or a column",
        "{q: deg, tau: mN.m}",
        "SI, or what the log says",
    ),
    "columns": Key(
        "a mapping",
        "which columns are which channels",
        '{q: "enc_{index}", time: stamp}',
        "by their names",
    ),
    "ignore": Key("a list of names", "columns to ignore", "[torque_raw]", _NONE),
    "max_rows": Key("a whole number", "a file with more rows is refused", "1000000", f"{MAX_ROWS}"),
}

ENTRY: Keys = {
    "file": Key("a path", "of the log, from the study's folder", "monday.csv"),
    "role": Key(
        "`fit` or `validate`",
        "used for fitting, or only to judge the result",
        "validate",
        "`fit`; if no entry has a role, the last third judges",
    ),
    "window": Key("two times [s]", "the part to read", "[2.0, 30.0]", "all of it"),
    "every": Key("a whole number", "read one row of this many", "2", "1"),
    "rate": Key(
        "a number [Hz]",
        "rows per second, if there is no column of times",
        "100",
        "by the column `time`",
    ),
    "columns": Key(
        "as of the study", "of this file instead of the study's", "{time: stamp}", "the study's"
    ),
}

SETUP: Keys = {
    "robot": Key(
        "a path", "another description, with the same joints", "loaded.urdf", "the study's"
    ),
    "base": Key("`held`", "a stand or a rope held the floating base", "held", "it floats"),
    "payload": Key(
        "a mapping",
        "a known attached body",
        "{link: tool, mass: 2.0, com: [0, 0, 0.05]}",
        _NONE,
    ),
    "compensated": Key(
        "true or false",
        "the controller's gravity compensation knows this robot and payload",
        "true",
        "false",
    ),
    "controller": Key(
        "a mapping",
        "keys of the study's controller that were different here",
        "{kp: [200, 200]}",
        "the study's",
    ),
    "session": Key(
        "text, a number or a date",
        "the day, or other conditions that recordings share",
        "monday",
        "one session, with all other entries without one",
    ),
    "temperature": Key(
        "a number, or one for each joint [deg C]", "stored and shown", "31.5", _NONE
    ),
    "surface": Key("text", "stored and shown", "rubber mat", _NONE),
}

PAYLOAD: Keys = {
    "link": Key("a link", "that holds it", "tool"),
    "mass": Key("a number [kg]", "of it", "2.0"),
    "com": Key("three numbers [m]", "its centre, in the link's frame", "[0, 0, 0.05]"),
    "inertia": Key(
        "3 or 6 numbers [kg m^2]",
        "about its own centre: moments, or xx xy yy xz yz zz",
        "[0.01, 0.01, 0.002]",
        "a point",
    ),
}

LAW: Keys = {
    "type": Key(
        "`unknown`, `pd`, `pid`, `cascade`, `voltage` or `table`", "the kind of law", "pd", "pd"
    ),
    "gravity_compensation": Key(
        "true or false",
        "it knows the model's gravity",
        "true",
        "false if gains are given, else estimated",
    ),
    "torque_limit": Key(_PER_JOINT, "largest torque that it commands [N m]", "[87, 12]", _NONE),
    "period": Key(
        "a number [s]",
        "of the controller, which holds its command for this time",
        "0.001",
        "that of the log",
    ),
    "unit": Key(_PER_JOINT, "what one unit of a gain is", "[0.002546]", "1"),
}

GAINS: Keys = {
    "kp": Key(
        _PER_JOINT,
        "torque per position error [N m/rad]; of a cascade, speed per position error [1/s]",
        "[300, null]",
        "estimated",
    ),
    "kd": Key(_PER_JOINT, "torque per speed error [N m s/rad]", "[20, 20]", "estimated"),
    "ki": Key(
        _PER_JOINT, "torque per integral of the error [N m/(rad s)]", "[50, 50]", "estimated"
    ),
    "kv": Key(
        _PER_JOINT, "of a cascade: torque per speed error [N m s/rad]", "[12, 12]", "estimated"
    ),
}

VOLTAGE: Keys = {
    "volts": Key("a number [V]", "of the supply, where none is logged", "12.0", "as logged"),
    "duty_limit": Key(_PER_JOINT, "share of the supply that is the most", "[1.0]", "1"),
    "torque_per_volt": Key(_PER_JOINT, "of a standing motor [N m/V]", "[0.3]", "fitted"),
    "back_emf": Key(_PER_JOINT, "torque lost per speed [N m s/rad]", "[0.9]", "fitted"),
    "supply_loss": Key(_PER_JOINT, "share of the supply that full duty loses", "[0.05]", "fitted"),
}

TABLE: Keys = {
    "table": Key(
        "pairs [error, effort]",
        "the law's effort by position error, errors rising",
        "[[-0.1, -5], [0.1, 5]]",
        "estimated",
    ),
}

BASE: Keys = {
    "link": Key("a link", "the robot's first", "trunk", "the robot's first"),
    "imu": Key(
        "a mapping", "where the IMU sits on that link", "{position: [0, 0, 0.1]}", "at its origin"
    ),
    "feet": Key(
        "a list of links, or a mapping by link",
        "what touches the ground",
        "[left_ankle, right_ankle]",
        _NONE,
    ),
    "ground": Key("a mapping", "as your simulator has it", "{friction: 0.8}", "level, at height 0"),
}

IMU: Keys = {
    "position": Key("three numbers [m]", "in the link's frame", "[-0.026, 0, 0.042]", "[0, 0, 0]"),
    "rpy": Key(
        "three numbers [rad]", "roll, pitch and yaw of its axes", "[0, 0, 1.5708]", "[0, 0, 0]"
    ),
}

FOOT: Keys = {
    "contact": Key(
        "`point` or `flat`",
        "a point, or a sole that can also turn the leg",
        "flat",
        "flat from four joints of the leg on",
    ),
    "sole": Key(
        "a number [m]",
        "from the link's frame down to the ground",
        "0.02",
        "a URDF's sphere, if the link has one",
    ),
}

GROUND: Keys = {
    "friction": Key(
        "a number", "Coulomb's, of all feet", "0.8", "not given: slipping says nothing of it"
    ),
    "height": Key("a number [m]", "in the frame of the base's pose", "0.0", "0"),
}

SIMULATOR: Keys = {
    "mjcf": Key("a path", "a MuJoCo model with its actuators", "go2.xml", "one of both is needed"),
    "urdf": Key(
        "a path", "a URDF, with gains in `controller:`", "arm.urdf", "one of both is needed"
    ),
    "actuators": Key(
        "a mapping", "which actuator moves a joint", "{elbow: motor2}", "by what the MJCF says"
    ),
}

TRUST: Keys = {
    "rigid_body": Key(
        "a share",
        "by which masses, centres and inertias may be off, one standard deviation",
        "0.05",
        "they are exact in figures; a tenth where something anomalous is claimed",
    ),
    "torque": Key("a share", "standard deviation of the torques' scale", "0.01", "0.04"),
}


def reference() -> dict[str, Keys]:
    """All tables by what they are of, in the order in which a study is written."""
    return {
        "the study": STUDY,
        "an entry of recordings: and simulation:": ENTRY,
        "an entry, by its kind of log": entry_keys(),
        "an entry, of how it was recorded": SETUP,
        "payload:": PAYLOAD,
        "controller:": LAW,
        "controller: gains": GAINS,
        "controller: {type: voltage}": VOLTAGE,
        "controller: {type: table}": TABLE,
        "base:": BASE,
        "base: imu:": IMU,
        "base: feet: LINK:": FOOT,
        "base: ground:": GROUND,
        "simulator:": SIMULATOR,
        "trust:": TRUST,
    }
