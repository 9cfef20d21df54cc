"""What is sealed: the answer to one study."""

from typing import Any

from bench.sim2real.concealed.draft import Draft
from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.reference import Reference
from bench.sim2real.concealed.spec import Truth, WorldSpec
from bench.sim2real.frame.arm import Array
from bench.sim2real.frame.study_files import joint_names


def truth_of(
    draft: Draft,
    effects: tuple[Effect, ...],
    order: Array,
    seen: dict[str, list[float]],
    size: float,
) -> Truth:
    """The answer; `size` is the hidden effect's, relative to the noise."""
    spec, sense, names = draft.spec, draft.sensors, joint_names(draft.arm)
    noise = {"tau": sense.tau_noise, "tau_step": sense.tau_step}
    noise |= {"q": sense.q_seen, "dq": sense.dq_noise}
    entries = []
    for index, effect in enumerate(effects):
        entries += _entries(effect, draft.ref, names, "hidden" if index == 0 else "second")
    return Truth(
        spec=spec,
        expected=_expected(spec),
        effects=tuple(entries),
        joints=tuple(names[k] for k in order),
        still=tuple(names[k] for k in sorted(draft.plan.style.still)),
        corner=draft.plan.corner,
        noise={
            **{name: values[order].tolist() for name, values in noise.items()},
            "tip": sense.tip_noise if sense.tip else None,
            "tip_turn": sense.tip_turn_noise if sense.tip else None,
        },
        wanted=draft.plan.size,
        size=round(size, 3),
        visibility={
            name: [values[k] for k in order] if len(values) == len(order) else values
            for name, values in seen.items()
        },
    )


def _expected(spec: WorldSpec) -> str:
    if spec.hide == "poor":
        return "cannot_tell"
    return {
        "clean": "no_mismatch",
        "still": "cannot_tell",
        "outside": "unknown",
        "lying": "lying_channel",
    }.get(spec.effect.partition(":")[0], "mismatch")


def _entries(effect: Effect, ref: Reference, names: list[str], role: str) -> list[dict[str, Any]]:
    gate = effect.gate
    parameters = getattr(effect, "parameters_of", lambda arm: effect.parameters())(ref.arm)
    place = {
        "joints": [names[k] for k in effect.joints(ref)],
        "links": [f"link{k + 1}" for k in effect.links(ref)],
        "recordings": None
        if gate.recordings is None
        else [f"rec{k + 1}.csv" for k in gate.recordings],
        "window": [gate.low, min(gate.high, 60.0)] if gate.kind == "time" else None,
        "position_window": [gate.low, gate.high] if gate.kind == "position" else None,
        "channel": getattr(effect, "of", None) if effect.id in CHANNELS else None,
        "kind": getattr(effect, "kind", None) or VARIANTS.get(effect.id, lambda e: None)(effect),
    }
    entries = [{"effect": effect.id, "parameters": parameters, "role": role, **place}]
    for name, values in effect.beside().items():
        entries.append({"effect": name, "parameters": values, "role": "beside", **place})
    return entries


CHANNELS = ("timestamp_skew", "sensor_gain", "sensor_noise", "lying_channel")
VARIANTS = {
    "command_delay": lambda effect: effect.of,
    "torque_gain": lambda effect: "drive" if effect.by_drive else "sensor",
    "torque_offset": lambda effect: "drive" if effect.by_drive else "sensor",
    "external_contact": lambda effect: "tip" if effect.at_tip else "origin",
    "unknown": lambda effect: type(effect).__name__.lower(),
    "coulomb_friction": lambda effect: "mujoco" if effect.native else "elastoplastic",
}


def size_of(seen: dict[str, list[float]]) -> float:
    return max(max(values) for name, values in seen.items() if name != "noise")
