"""Studies as people have them: description, recordings and study.yaml, and what is known of them.

What is known is by an independent fit, or by the code that came with the recordings.
"""

import shutil
from functools import partial
from pathlib import Path
from typing import Any

import yaml

from bench.sim2real.proof.real_counts import Finding
from bench.sim2real.proof.real_facts import (
    DRY,
    FRICTION,
    Range,
    depends_on_position,
    either_friction,
    figures_at,
    left_at_most,
    no_load_beyond,
    of_position,
    only,
    or_refused,
    tilt_about_y,
)
from bench.sim2real.proof.real_machine import Machine

JUMPS = ("jump", "wrap")  # words of a refusal that names what is wrong


def _joints(values: dict[int, float]) -> dict[str, Range]:
    """Figures that are known, by the joints' numbers."""
    return {f"joint{k}": (value, value) for k, value in values.items()}


def _of_lying_arm(finding: Finding) -> bool:
    return finding["effect"] in FRICTION | {"gravity_direction", "torque_offset", "rotor_inertia"}


def _of_cable(finding: Finding) -> bool:
    plain = ("coulomb_friction", "viscous_friction", "torque_offset")
    return finding["effect"] in plain or of_position(finding)


def _of_poor_log(finding: Finding) -> bool:
    moved, light = {f"joint{k}" for k in (1, 3, 4, 6, 7)}, {"joint1", "joint4"}
    may = {**dict.fromkeys((*DRY, "viscous_friction"), moved), "unknown": light}
    return set(finding["joints"]) <= may.get(finding["effect"], set())


def _of_drive(finding: Finding) -> bool:
    may = ("coulomb_friction", "viscous_friction", "rotor_inertia", "sensor_gain")
    return finding["effect"] in may


def _whole(source: Path, folder: Path) -> dict[str, Any]:
    """A study as somebody has it."""
    for path in sorted(source.iterdir()):
        shutil.copyfile(path, folder / path.name)
    return dict(yaml.safe_load((source / "study.yaml").read_text()))


STRANGERS = (
    Machine(
        name="arm_on_its_side",
        under="strangers",
        title="Seven-joint arm of a robot with two, mounted lying, 60 s at 50 Hz",
        withheld="How it is mounted: the URDF stands upright. All friction, the rotors' inertia.",
        doubtful="What is known is another fit; by it gravity is (9.97, -0.23, -0.15) m/s^2.",
        known={
            "gravity along +x of its base: turned by 80 to 100 degrees about y": partial(
                tilt_about_y, least=80.0, most=100.0
            ),
            "dry friction of joints 3 to 7: .26, .51, .17, .48, .105 N m, within 30 %": partial(
                figures_at,
                effects=DRY,
                parameter="level",
                known=_joints({3: 0.26, 4: 0.51, 5: 0.17, 6: 0.48, 7: 0.105}),
                share=0.3,
            ),
            "offsets of joints 2, 4 and 6: 0.6, 0.4, -0.28 N m, within 30 %": partial(
                figures_at,
                effects=("torque_offset",),
                parameter="offset",
                known=_joints({2: 0.6, 4: 0.4, 6: -0.28}),
                share=0.3,
            ),
            "no mass, spring, wrong sensor or nameless torque": partial(only, may=_of_lying_arm),
            "held out at most 1.5 times 0.27, 0.26, 0.13, 0.23, 0.07, 0.09, 0.03 N m": partial(
                left_at_most,
                most={
                    f"joint{k}": 1.5 * left
                    for k, left in enumerate((0.27, 0.26, 0.13, 0.23, 0.07, 0.09, 0.03), 1)
                },
            ),
        },
        build=_whole,
    ),
    Machine(
        name="cable_at_a_wrist",
        under="strangers",
        title="One joint of a surgical master arm with a cable, 24 s at 200 Hz",
        withheld="The cable and the friction.",
        doubtful="It moves once up and once down, at one speed.",
        known={
            "a cable's torque depends on position": partial(depends_on_position, joint="joint1"),
            "dry friction of 0.072 N m, within 30 %": partial(
                figures_at,
                effects=("coulomb_friction",),
                parameter="level",
                known=_joints({1: 0.072}),
                share=0.3,
            ),
            "one speed: Coulomb's and viscous friction cannot be told apart": partial(
                either_friction, joint="joint1"
            ),
            "nothing else, no friction that gives way": partial(only, may=_of_cable),
            "held out at most 0.02 N m": partial(left_at_most, most={"joint1": 0.02}),
        },
        build=_whole,
    ),
    Machine(
        name="poor_serial_log",
        under="strangers",
        title="Seven-joint arm on a slow serial line, 12 to 38 Hz",
        withheld="All friction, and what is wrong with its masses.",
        doubtful="Gaps of 0.3 s; one joint moves in each file, joints 2 and 5 never do.",
        known={
            "dry friction of joints 1 and 3: .7 to 1.0 and .2 to .4 N m, or nothing said": partial(
                figures_at,
                effects=DRY,
                parameter="level",
                known={"joint1": (0.7, 1.0), "joint3": (0.2, 0.4)},
                optional=True,
            ),
            "masses cannot be told": partial(no_load_beyond, most=0.0),
            "little is sure: at most two names beside dry or viscous friction of joints that move"
            " and a nameless torque of 1 and 4": partial(only, may=_of_poor_log, needless=2),
        },
        build=_whole,
    ),
    Machine(
        name="wrapped_encoder",
        under="strangers",
        title="A drive on a bench, 3 x 72 s at 48 Hz",
        withheld="Friction and the rotor's inertia; that the encoder wraps.",
        doubtful="Positions jump by 25 rad where the encoder wraps, and change twice as fast as the"
        " logged speed.",
        known={
            "dry friction of 0.45 to 0.50 N m, or a refusal that names the jumps": partial(
                or_refused,
                why=JUMPS,
                fact=partial(
                    figures_at,
                    effects=("coulomb_friction",),
                    parameter="level",
                    known={"joint1": (0.45, 0.50)},
                ),
            ),
            "rotor of 0.03 to 0.06 kg m^2, or that refusal": partial(
                or_refused,
                why=JUMPS,
                fact=partial(
                    figures_at,
                    effects=("rotor_inertia",),
                    parameter="inertia",
                    known={"joint1": (0.03, 0.06)},
                ),
            ),
            "nothing else but viscous friction and a speed half of the positions'": partial(
                only, may=_of_drive
            ),
        },
        build=_whole,
    ),
)
