"""Machines for `pdoik compare` that have what no simulator has words for, and their answers.

They are those of ../concealed, which shares no code with pdoik: dry friction with presliding,
Stribeck's, play, elasticity, ripple; a controller that samples; noisy, quantised encoders with lost
rows. The user's simulator is their URDF under their gains, which knows nothing of it.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd
import yaml

from bench.sim2real.concealed import spec as concealed
from bench.sim2real.concealed.build import drawn, write_machine
from bench.sim2real.concealed.draft import Draft, draft_of
from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.effects_friction import Coulomb, Viscous
from bench.sim2real.frame.study_files import write_truth

SECONDS = {"fit": 13.0, "validate": 7.0}  # of the recordings that are given
RUBS = (0.003, 0.02)  # of the drive's effort: friction of a background, and viscous at 1 rad/s

SAID: dict[str, tuple[str, ...]] = {
    "viscous_friction": ("damping", "kv"),
    "coulomb_friction": ("frictionloss",),
    "rotor_inertia": ("armature",),
    "payload": ("payload", "mass"),
    "torque_gain": ("kp",),
    "torque_offset": ("spring",),
    "position_dependent_spring": ("stiffness", "spring"),
    "command_delay": ("delay",),
    "joint_offset": ("ref",),
}
"""What a simulator has a word for, and the words that are right."""

NEAR: dict[str, tuple[str, ...]] = {
    "stribeck_friction": ("frictionloss", "damping", "kv"),
    "asymmetric_friction": ("frictionloss", "damping", "kv", "spring"),
    "load_dependent_friction": ("frictionloss", "damping", "kv"),
    "presliding_hysteresis": ("frictionloss", "stiffness", "spring"),
    "backlash": ("delay", "kp", "ref"),
    "joint_elasticity": ("kp", "armature"),
    "torque_saturation": (),
    "torque_ripple": (),
    "joint_coupling": (),
}
"""What it has none for, and the words that come nearest: right where one is lenient."""

BACKGROUNDS = ("none", "rubs", "inertia")


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldSpec:
    """One world to be made."""

    name: str
    seed: int
    robot: str
    effect: str  # of bench.sim2real.concealed's catalogue, or clean
    background: str
    torque: bool  # whether it is logged


def specs_of(first: int, count: int) -> list[WorldSpec]:
    """Worlds from a first seed on, in an order that only the seed tells."""
    rng = np.random.default_rng([first, 7])
    effects = [*SAID, *NEAR, "clean", "clean"]
    drawn_effects = [
        str(each)
        for k in range(count)
        for each in rng.permutation(effects)
        if k % len(effects) == 0
    ][:count]
    return [
        WorldSpec(
            name=f"pair{k + 1:03d}",
            seed=first + k,
            robot=str(rng.choice(["random2", "random3"])),
            effect=effect,
            background=str(rng.choice(BACKGROUNDS, p=[0.3, 0.45, 0.25])),
            torque=bool(rng.random() < 0.3),
        )
        for k, effect in enumerate(drawn_effects)
    ]


def make_study(folder: Path, job: WorldSpec, truth_folder: Path) -> None:
    """Writes the study of a machine, compare.yaml in it, and elsewhere what the machine has."""
    size = float(np.random.default_rng([job.seed, 3]).uniform(8.0, 40.0))
    for attempt in range(6):
        spec = concealed.WorldSpec(
            seed=job.seed,
            effect=job.effect,
            hide="inertia" if job.background == "inertia" else "plain",
            robot=job.robot,
            size=size * 0.6**attempt,
        )
        draft = _short(draft_of(spec))
        effects = drawn(draft)
        around = _rubs(draft, effects) if job.background == "rubs" else ()
        try:
            write_machine(folder, draft, (*effects, *around))
        except RuntimeError:
            continue
        _for_compare(folder, draft, job)
        write_truth(truth_folder, folder, _answer(job, draft, effects, around))
        return
    raise RuntimeError(f"{job}: no arm bears it")


def _short(draft: Draft) -> Draft:
    """One recording to fit and one to judge."""
    motions = []
    for role, seconds in SECONDS.items():
        motion = draft.motions[draft.roles.index(role)]
        count = int(np.searchsorted(motion.time, seconds + 0.5))
        parts = {name: getattr(motion, name)[:count] for name in motion.__slots__}
        motions.append(replace(motion, **parts))
    return replace(draft, roles=list(SECONDS), motions=motions)


def _rubs(draft: Draft, effects: tuple[Effect, ...]) -> tuple[Effect, ...]:
    """Dry and viscous friction in all joints, each as large as it may be."""
    rng, found = draft.spec.stream("background"), list[Effect]()
    hidden = {(e.id, j) for e in effects for j in e.joints(draft.ref)}
    for j, joint in enumerate(draft.arm.joints):
        level, slope = (rng.uniform(*RUBS, 2) * joint.effort).tolist()
        if ("coulomb_friction", j) not in hidden:
            inertia = float(0.8 * draft.ref.lightest[j])
            found.append(Coulomb(joint=j, size=level, inertia=inertia))
        if ("viscous_friction", j) not in hidden:
            found.append(Viscous(joint=j, coefficient=slope))
    return tuple(found)


def _for_compare(folder: Path, draft: Draft, job: WorldSpec) -> None:
    """compare.yaml, and recordings as short as they are given."""
    study = yaml.safe_load((folder / "study.yaml").read_text())
    study["simulator"] = {"urdf": study.pop("robot")}
    study.pop("tip", None)
    study.pop("trust", None)
    for entry, seconds in zip(study["recordings"], SECONDS.values(), strict=True):
        table = pd.read_csv(folder / entry["file"])
        table = table[table["time"] < table["time"].iloc[0] + seconds]
        unseen = ("tip.", "dq.") if job.torque else ("tip.", "dq.", "tau.", "tau_cmd.")
        kept = [name for name in table.columns if not name.startswith(unseen)]
        table[kept].to_csv(folder / entry["file"], index=False)
    (folder / "compare.yaml").write_text(yaml.safe_dump(study, sort_keys=False))
    (folder / "study.yaml").unlink()


def _answer(
    job: WorldSpec, draft: Draft, effects: tuple[Effect, ...], around: tuple[Effect, ...]
) -> dict[str, object]:
    """What is there: of each effect its places and figures, hidden or of the background."""
    names = [f"joint{k + 1}" for k in range(draft.arm.n)]
    entries = []
    for role, group in (("hidden", effects), ("background", around)):
        for each in group:
            figures = getattr(each, "parameters_of", lambda arm, e=each: e.parameters())
            entries.append(
                {
                    "effect": each.id,
                    "role": role,
                    "joints": [names[k] for k in each.joints(draft.ref)],
                    "links": [f"link{k + 1}" for k in each.links(draft.ref)],
                    "parameters": figures(draft.arm),
                    "beside": list(each.beside()),
                }
            )
    masses = {f"link{k + 1}": link.mass for k, link in enumerate(draft.arm.links)}
    return {
        "job": {key: getattr(job, key) for key in job.__slots__},
        "effects": entries,
        "masses": masses if job.background == "inertia" else {},
    }
