"""The catalogue's pages, made of the effects themselves: python python/docs/effects_pages.py."""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np
from effects_pictures import draw, signal_of

from pdoik.sim2real.effect_check.arm import Arm
from pdoik.sim2real.effects import CATALOGUE, Effect

PAGES = Path(__file__).parent / "generated" / "effects"


def main() -> None:
    """Write them anew."""
    shutil.rmtree(PAGES, ignore_errors=True)
    PAGES.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as folder:
        arm = Arm(Path(folder))
        for effect in CATALOGUE.values():
            signal = signal_of(effect, arm)
            assert signal is not None, f"{effect.id}: neither an example nor a sketch"
            draw(signal, PAGES / f"{effect.id}.svg")
            (PAGES / f"{effect.id}.md").write_text(page(effect, signal.caption))
    (PAGES / "index.md").write_text(index())


def page(effect: Effect, caption: str) -> str:
    """One effect in words and numbers."""
    title = capital(effect.words)
    lines = [f"# {title}", "", effect_words(effect), "", f"```text\n{effect.equation}\n```", ""]
    lines += ["## What it does to a signal", "", f"![{title}]({effect.id}.svg)", ""]
    lines += [f"*{caption}*", ""]
    lines += ["## Parameters", ""]
    lines += ["| parameter | unit | from | to | example |", "| --- | --- | ---: | ---: | ---: |"]
    values = effect.example.values if effect.example else {}
    for each in effect.parameters:
        example = f"{values[each.name]:g}" if each.name in values else ""
        ends = " | ".join("" if np.isinf(v) else f"{v:g}" for v in (each.lower, each.upper))
        lines.append(f"| `{each.name}` | {each.unit} | {ends} | {example} |")
    lines.append("")
    lines += ["## How to distinguish it", ""]
    if effect.confused_with:
        others = ", ".join(
            f"[{CATALOGUE[name].words}]({name}.md)" if name in CATALOGUE else name
            for name in effect.confused_with
        )
        lines += [f"Similar effects: {others}.", ""]
    if effect.decided_by:
        lines += [f"What decides between them: {effect.decided_by}.", ""]
    if effect.source:
        lines += ["## Source", "", f"{effect.source}.", ""]
    lines.append(f"`pdoik effects show {effect.id}` prints the same in a terminal.")
    return "\n".join(lines) + "\n"


def effect_words(effect: Effect) -> str:
    """What it is, then where it acts."""
    cls = type(effect)
    alone = sum(type(each).__module__ == cls.__module__ for each in CATALOGUE.values()) == 1
    module = sys.modules[cls.__module__].__doc__ if alone else ""
    said = "\n\n".join(" ".join(doc.split()) for doc in (module, cls.__doc__) if doc)
    part = " It may act in a part of the time only, or between two positions." * effect.gated
    return f"{said}\n\nIt acts on: {effect.on}. Family: {effect.family}.{part}"


def capital(words: str) -> str:
    """With a capital letter first."""
    return words[0].upper() + words[1:]


def index() -> str:
    """The list, by family."""
    text = "# The catalogue of effects\n\nWhat `pdoik diagnose` can name, a page for each.\n"
    for family in dict.fromkeys(each.family for each in CATALOGUE.values()):
        names = "\n".join(name for name, each in CATALOGUE.items() if each.family == family)
        text += f"\n## {capital(family)}\n\n```{{toctree}}\n:maxdepth: 1\n\n{names}\n```\n"
    return text


if __name__ == "__main__":
    main()
