"""Words that logs use for channels, roles and units, and those that say it is something else."""

from __future__ import annotations

from ..units import KNOWN


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


QUANTITIES: dict[tuple[str, ...], str] = {
    words: quantity
    for quantity, spellings in {
        "time": "time,t,timestamp,timestamps,stamp,times,time stamp,tick,ticks,clock,elapsed",
        "q": "q,pos,position,positions,angle,angles,qpos",
        "dq": "dq,qd,qdot,dotq,q dot,vel,velocity,velocities,speed,speeds,qvel",
        "tau": "tau,torque,torques,effort,efforts,eff,torq,trq,moment,moments,qfrc actuator",
        "current": "current,currents,curr,i",
        "duty": "duty,pwm,duty cycle",
        "voltage": "voltage,voltages,volt,volts,supply voltage,battery voltage,bus voltage,vbus",
        "ctrl": "ctrl",
        "actuator_force": "actuator force",
    }.items()
    for words in (tuple(each.split()) for each in spellings.split(","))
}
"""What is measured, by the words for it. The last two are MuJoCo's, of an actuator."""

JOINED: dict[str, tuple[str, ...]] = {
    "qdes": ("q", "des"),
    "dqdes": ("dq", "des"),
    "qcmd": ("q", "cmd"),
    "qref": ("q", "ref"),
    "taucmd": ("tau", "cmd"),
    "taudes": ("tau", "des"),
    "secs": ("sec",),
}
"""Words written as one."""

COMMANDED = _words(
    "cmd command commands commanded target targets des desired d ref reference goal setpoint"
    " setpoints sp set action actions computed"
)
TICKS = _words("tick ticks clock elapsed")
"""Words for the time that stand next to better ones."""

CLOCKS = _words(
    "sim simulation elapsed unix epoch wall system host utc local recv received rx since start"
    " rosbag bag"
)
"""Words that say whose time it is."""

MEASURED = _words(
    "meas msr measured measurement measurements actual act est estimated present now feedback fb"
    " state states obs observation observations sensed applied"
)
EMPTY = _words(
    "joint joints jnt j axis axes dof dofs robot value values data the field header"
    " articulation articulations controller ros"
)
"""Words that say nothing of the channel."""

OTHER = _words(
    "error errors err acc accel acceleration accelerations qacc qdd ddq std stddev var"
    " variance covariance min max limit limits lower upper temp temperature temperatures ext"
    " external ee eef tcp tip cartesian pose root body base sin cos gain gains kp kd ki offset"
    " stiffness damping gravity bias rel relative delta diff initial next previous status mode"
    " output outputs quat quaternion x y z wxyz xyzw reward dones"
)
"""Words that say a column is no channel, wherever they stand in its name."""

MUJOCO = {"qpos": "qpos", "qvel": "dof", "qfrc": "dof", "ctrl": "actuator", "actuator": "actuator"}
"""First words of MuJoCo's vectors, and what their entries are counted by."""

CHANNELS_OF: dict[tuple[str, bool], str] = {
    ("q", False): "q",
    ("q", True): "q_des",
    ("dq", False): "dq",
    ("dq", True): "dq_des",
    ("tau", False): "tau",
    ("tau", True): "tau_cmd",
    ("current", False): "current",
    ("duty", False): "duty",
    ("duty", True): "duty",  # of a drive, they are the same
    ("voltage", False): "voltage",
}
"""The channel of a quantity, measured or commanded; no other is read."""

_SPELLINGS = {
    "rad": "rads radian radians",
    "deg": "degs degree degrees °",
    "turn": "turns rev revs revolutions",
    "rad/s": "rads radpersec radpers radps radsec radianspersecond",
    "deg/s": "degs degpersec degpers dps degsec degreespersecond °s",
    "turn/s": "turnss revs rps turnpers turnspersecond",
    "rpm": "",
    "N.m": "nm newtonmeter newtonmeters",
    "mN.m": "mnm",
    "N.cm": "ncm",
    "kN.m": "knm",
    "A": "amp amps ampere amperes",
    "mA": "milliamp milliamps",
    "V": "volt volts",
    "mV": "millivolt millivolts",
    "s": "sec secs second seconds",
    "ms": "msec millisec milliseconds",
    "us": "µs usec usecs microsec microseconds",
    "ns": "nsec nsecs nanosec nanosecs nanoseconds",
    "%": "percent",
    "permille": "",
}


def plain(unit: str) -> str:
    """A unit without what spellings differ in: "[N·m]" and "Nm" are "nm"."""
    return "".join(each for each in unit.lower() if each.isalnum() or each in "%°")


UNITS: dict[str, dict[str, str]] = {
    quantity: {
        spelling: unit
        for unit in units
        for spelling in (plain(unit), *_SPELLINGS.get(unit, "").split())
    }
    for quantity, units in KNOWN.items()
}
"""Units of each quantity by their plain spelling."""

ANY_UNIT = frozenset(
    spelling for units in UNITS.values() for spelling in units if not spelling.isdigit()
)
"""What stands in brackets and is one of these is a unit."""
