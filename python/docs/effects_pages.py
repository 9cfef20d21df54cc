"""The catalogue's pages, made of the effects themselves: python python/docs/effects_pages.py.

Each is tried at its own example on the arm of `pdoik effects check`, and drawn: the balance that it
changes most, with and without it, and what it adds over what its law is about.
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from pdoik.sim2real.effect_check.arm import JOINTS, Arm
from pdoik.sim2real.effect_check.trial import Trial
from pdoik.sim2real.effects import CATALOGUE, Effect
from pdoik.sim2real.motion.place import Key

PAGES = Path(__file__).parent / "generated" / "effects"
WITHOUT, WITH = "#b0b4ba", "#1f6fb4"
SHOWN = (2.0, 6.0)  # of the example [s]
BALANCES = {
    "torque": "torque",
    "drive": "torque reported less commanded",
    "law": "command less the controller's law",
    "velocity": "speed less the positions' derivative",
    "servo": "position less its command",
    "tip": "measured tip less the model's",
}
UNITS = {"velocity": "rad/s", "servo": "rad", "tip": "m or rad"}
OVER = {"speed": "speed [rad/s]", "q": "position [rad]", "load": "load [N m]"}


def main() -> None:
    """Write them anew."""
    shutil.rmtree(PAGES, ignore_errors=True)
    PAGES.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as folder:
        arm = Arm(Path(folder))
        for effect in CATALOGUE.values():
            (PAGES / f"{effect.id}.md").write_text(page(effect, drawn(effect, arm)))
    (PAGES / "index.md").write_text(index())


def page(effect: Effect, is_drawn: bool) -> str:
    """One effect in words and numbers."""
    title = effect.words[0].upper() + effect.words[1:]
    lines = [f"# {title}", "", f"```text\n{effect.equation}\n```", "", effect_words(effect), ""]
    if is_drawn:
        lines += [f"![{title} on an example arm]({effect.id}.svg)", ""]
        lines += ["*On an example arm of three joints, at the figures of the table.*", ""]
    lines += ["| figure | unit | from | to | example |", "| --- | --- | ---: | ---: | ---: |"]
    values = effect.example.values if effect.example else {}
    for each in effect.parameters:
        example = f"{values[each.name]:g}" if each.name in values else ""
        ends = " | ".join("" if np.isinf(v) else f"{v:g}" for v in (each.lower, each.upper))
        lines.append(f"| `{each.name}` | {each.unit} | {ends} | {example} |")
    lines.append("")
    if effect.confused_with:
        others = ", ".join(
            f"[{CATALOGUE[name].words}]({name}.md)" if name in CATALOGUE else name
            for name in effect.confused_with
        )
        lines += ["## What looks like it", "", f"{others}.", ""]
    if effect.decided_by:
        lines += [f"What decides: {effect.decided_by}.", ""]
    if effect.beside:
        names = ", ".join(CATALOGUE[name].words for name in effect.beside if name in CATALOGUE)
        lines += [f"It is only looked for where this was found, too: {names}.", ""]
    if effect.source:
        lines += ["## Source", "", f"{effect.source}.", ""]
    lines.append(f"`pdoik effects show {effect.id}` says the same in a terminal.")
    return "\n".join(lines) + "\n"


def effect_words(effect: Effect) -> str:
    """Its class's first lines, then where it sits."""
    said = " ".join((type(effect).__doc__ or "").split())
    part = " It may act in a part of the time, or between two positions, only." * effect.gated
    return f"{said}\n\nIt sits at: {effect.on}. Family: {effect.family}.{part}"


def drawn(effect: Effect, arm: Arm) -> bool:
    """Whether there is a picture of it now: it must have an example that adds to a balance."""
    if effect.example is None:
        return False
    trial = Trial(effect, effect.example, arm)
    if trial.place is None:
        return False
    balances = trial.plain
    added = {
        key: column @ trial.beta
        for key, column in balances.compute(effect, trial.place, trial.shape).items()
    }
    rows = (balances.time >= SHOWN[0]) & (balances.time <= SHOWN[1])
    added = {key: each for key, each in added.items() if each[rows].any()}
    if not added:
        return False
    key = max(added, key=lambda each: shown_first(added, each))
    figure = Figure(figsize=(9.0, 2.8), layout="constrained")
    over_time, over_law = figure.subplots(1, 2)
    motion = trial.motion
    model = np.interp(balances.time, motion.time, motion.borne[:, key[1]])
    before = model if key[0] == "torque" else np.zeros(len(balances.time))
    joint = JOINTS[key[1]] if key[0] != "tip" else ""
    unit = UNITS.get(key[0], "N m")
    over_time.plot(balances.time[rows], before[rows], color=WITHOUT, label="without")
    over_time.plot(balances.time[rows], (before + added[key])[rows], color=WITH, label="with")
    over_time.set(xlabel="time [s]", ylabel=f"{BALANCES[key[0]]} {joint}\n[{unit}]")
    over_time.legend(frameon=False, fontsize=8)
    axis = key[1] if key[0] != "tip" else 1
    law = {"speed": motion.dq[:, axis], "q": motion.q[:, axis], "load": motion.borne[:, axis]}
    where = np.interp(balances.time, motion.time, law[effect.against])
    over_law.plot(where, added[key], ".", color=WITH, markersize=1.5)
    over_law.set(xlabel=OVER[effect.against], ylabel=f"added [{unit}]")
    for each in (over_time, over_law):
        each.spines[["top", "right"]].set_visible(False)
    figure.savefig(PAGES / f"{effect.id}.svg", metadata={"Date": None})
    return True


def shown_first(added: dict[Key, np.ndarray], key: Key) -> tuple[bool, float]:
    """Torques before other balances, then by size."""
    return key[0] == "torque", float(np.mean(added[key] ** 2))


def index() -> str:
    """The list, by family."""
    text = "# The catalogue of effects\n\nWhat `pdoik diagnose` can name, a page each.\n"
    for family in dict.fromkeys(each.family for each in CATALOGUE.values()):
        names = "\n".join(name for name, each in CATALOGUE.items() if each.family == family)
        text += f"\n```{{toctree}}\n:caption: {family}\n:maxdepth: 1\n\n{names}\n```\n"
    return text


if __name__ == "__main__":
    main()
