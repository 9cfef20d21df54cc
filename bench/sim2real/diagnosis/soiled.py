"""Concealed studies as machines are: a background of friction, wrong inertias, scales and days.

    python -m bench.sim2real.diagnosis.soiled RUN OUT [--every N] [--workers N]

RUN is a folder of ../proof on development seeds. Of each of its studies that hides an effect,
OUT/studies gets a copy whose log is that of a dirtier machine, and OUT/sealed its truth. To the
same motion other torques are added: Coulomb and viscous friction in every joint, a tenth different
from recording to recording. Every torque is off by a constant factor, every link's inertial figures
in the description by a tenth; the log is thinned to 100 Hz and rounded to 14 bits of position and
12 of torque; gains, commanded torques and speeds are not told. Each copy is diagnosed blind, as
../proof does it; OUT/studies.parquet has a row per study. It goes on where it was stopped.
"""

import json
import re
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer
import yaml
from numpy.typing import NDArray
from rich.progress import track

from bench.common.blind import as_diagnosis, blind
from bench.common.campaign import Row
from bench.common.whole_files import write_text, write_whole
from bench.sim2real.proof.score import GROUPS

RATE = 100.0  # [Hz]
POSITION_BITS, TORQUE_BITS = 14, 12
FRICTION = (0.02, 0.06)  # of a joint's effort limit: Coulomb's; viscous at the speed limit the same
BY_DAY, FACTOR, INERTIA = 0.1, 0.04, 0.075  # standard deviations, relative
_SMOOTH = 0.01  # [rad/s]


def main(
    run: Annotated[Path, typer.Argument(help="Folder of bench.sim2real.proof.")],
    out: Annotated[Path, typer.Argument(help="Folder to fill.")],
    every: Annotated[int, typer.Option(min=1, help="One study in so many.")] = 1,
    workers: Annotated[int, typer.Option(min=1, help="Studies at a time.")] = 2,
) -> None:
    """Soil a run's studies and diagnose them."""
    truths = sorted((run / "sealed").glob("*.json"))
    specs = {path: json.loads(path.read_text())["spec"] for path in truths}
    kept = [
        path
        for path, spec in specs.items()
        if spec["effect"].partition(":")[0] not in GROUPS and spec["hide"] != "no_torque"
    ][::every]
    for folder in ("sealed", "said"):
        (out / folder).mkdir(parents=True, exist_ok=True)
    for path in kept:
        if not (out / "sealed" / path.name).is_file():
            truth = json.loads(path.read_text())
            soil(run / "studies" / path.stem, out / "studies" / path.stem, truth)
            write_text(out / "sealed" / path.name, json.dumps(truth, indent=1) + "\n")
    with ThreadPoolExecutor(workers) as pool:
        list(track(pool.map(partial(_said, out), kept), "diagnose", len(kept)))
    rows = [_row(out, path.name) for path in kept]
    write_whole(
        out / "studies.parquet",
        lambda path: pd.DataFrame(rows).to_parquet(path, compression="zstd"),
    )


def _said(out: Path, path: Path) -> None:
    to = out / "said" / path.name
    if not to.is_file():
        write_text(to, json.dumps(blind(out / "studies" / path.stem)) + "\n")


def _row(out: Path, name: str) -> Row:
    """What was hidden and what was said, in JSON."""
    truth = json.loads((out / "sealed" / name).read_text())
    said = json.loads((out / "said" / name).read_text())
    diagnosis = as_diagnosis(said)
    row: Row = {"name": Path(name).stem, "group": "effect", **truth["spec"]}
    row |= {"verdict": diagnosis["verdict"], "seconds": said["seconds"]}
    row["hidden"] = json.dumps(truth["effects"])
    for key in ("findings", "suspected", "joints", "notes"):
        row[key] = json.dumps(diagnosis.get(key, []))
    return row


def soil(study: Path, to: Path, truth: dict[str, Any]) -> None:
    """One study's copy; what is added to the truth are the background's effects."""
    to.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng([truth["spec"]["seed"], 16])
    content = yaml.safe_load((study / "study.yaml").read_text())
    joints, limits = content["joints"], _limits((study / "robot.urdf").read_text())
    for key in ("controller", "simulation"):
        content.pop(key, None)
    dirt = pd.DataFrame(limits, index=["effort", "speed"]).T.loc[joints]
    dirt["size"] = [rng.uniform(*FRICTION) * limits[j][0] for j in joints]
    dirt["slope"] = [rng.uniform(*FRICTION) * limits[j][0] / limits[j][1] for j in joints]
    dirt["factor"] = [1.0 + FACTOR * rng.standard_normal() for _ in joints]
    for entry in content["recordings"]:
        dirt["day"] = [1.0 + BY_DAY * rng.standard_normal() for _ in joints]
        write_text(to / entry["file"], _soiled(pd.read_csv(study / entry["file"]), dirt))
    write_text(to / "robot.urdf", _misjudged((study / "robot.urdf").read_text(), rng))
    write_text(to / "study.yaml", yaml.safe_dump(content))
    for name, figure, key in (
        ("coulomb_friction", "size", "level"),
        ("viscous_friction", "slope", "coefficient"),
        ("torque_gain", "factor", "gain"),
        ("sensor_gain", "factor", "gain"),
    ):
        told = dirt[figure].items()
        truth["effects"] += [_entry(name, [j], [], {key: float(value)}) for j, value in told]
    links = [f"link{k + 1}" for k in range(len(joints))]
    truth["effects"] += [_entry("link_inertial_error", [], [link], {}) for link in links]
    truth["effects"].append(_entry("payload", [], links[-1:], {}))


def _entry(effect: str, joints: list[str], links: list[str], figures: dict[str, float]) -> Any:
    place = {"effect": effect, "joints": joints, "links": links, "parameters": figures}
    nowhere = ("recordings", "window", "position_window", "channel", "kind")
    return {**place, **dict.fromkeys(nowhere), "role": "background"}


def _limits(urdf: str) -> dict[str, tuple[float, float]]:
    pattern = r'<joint name="([^"]+)".*?effort="([^"]+)" velocity="([^"]+)"'
    return {n: (float(e), float(v)) for n, e, v in re.findall(pattern, urdf, re.DOTALL)}


def _misjudged(urdf: str, rng: np.random.Generator) -> str:
    """Masses and inertias scaled, link by link: bodies stay bodies."""

    def scaled(match: re.Match[str]) -> str:
        factor = max(1.0 + INERTIA * rng.standard_normal(), 0.5)
        body = match.group(0)
        for name in ("mass value", "ixx", "iyy", "izz", "ixy", "ixz", "iyz"):
            body = re.sub(
                rf'({name}=")([^"]+)"', lambda m: f'{m[1]}{factor * float(m[2]):.9g}"', body
            )
        return body

    return re.sub(r"<inertial>.*?</inertial>", scaled, urdf, flags=re.DOTALL)


def _soiled(table: pd.DataFrame, dirt: pd.DataFrame) -> str:
    """A recording's rows as the dirtier machine would have logged them."""
    time = table["time"].to_numpy()
    step = max(1, round(1.0 / (RATE * float(np.median(np.diff(time))))))
    for own in dirt.itertuples():
        j, q = own.Index, table[f"q.{own.Index}"].to_numpy()
        dq = table[f"dq.{j}"].to_numpy() if f"dq.{j}" in table else np.gradient(q, time)
        rubbed = own.day * (own.size * np.tanh(dq / _SMOOTH) + own.slope * dq)
        tau = own.factor * (table[f"tau.{j}"].to_numpy() + rubbed)
        table[f"tau.{j}"] = _rounded(tau, 2.0 * own.effort / 2**TORQUE_BITS)
        table[f"q.{j}"] = _rounded(q, 2.0 * np.pi / 2**POSITION_BITS)
    dropped = [c for c in table if c.startswith(("tau_cmd.", "dq.", "dq_des."))]
    return str(table.drop(columns=dropped).iloc[::step].to_csv(index=False, float_format="%.9g"))


def _rounded(values: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    return np.round(values / step) * step


if __name__ == "__main__":
    typer.run(main)
