"""The page of study.yaml, made of the tables that its readers check keys by."""

from __future__ import annotations

from pathlib import Path

from pdoik.sim2real.study.key_tables import reference

FILE = Path(__file__).parent / "generated" / "study_yaml.md"
HEAD = """# study.yaml, key by key

A study names the robot's description, recordings of the machine, and what is known of it.
`pdoik study new` writes one, `pdoik study check` reads it, `pdoik study keys` prints this page in a
terminal. Paths are relative to the study's folder. A key that is not here is refused, with the
nearest one named.
"""


def main() -> None:
    """Write it anew."""
    FILE.parent.mkdir(exist_ok=True)
    text = [HEAD]
    for title, table in reference().items():
        text.append(f"## {title[0].upper()}{title[1:]}\n")
        text.append(
            "| key | value | meaning | without it | example |\n| --- | --- | --- | --- | --- |"
        )
        for name, key in table.items():
            cells = (f"`{name}`", key.kind, key.words, key.default or "needed")
            text.append(f"| {' | '.join(cells)} | `{name}: {key.example}` |")
        text.append("")
    FILE.write_text("\n".join(text))


if __name__ == "__main__":
    main()
