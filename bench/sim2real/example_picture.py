"""The picture of `pdoik diagnose` in the README: a concealed Panda with two causes.

python -m bench.sim2real.example_picture bench/sim2real/diagnose.png
"""

import io
from pathlib import Path
from tempfile import TemporaryDirectory

import typer
from PIL import Image

from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import WorldSpec
from pdoik import sim2real

WORLD = WorldSpec(seed=7, effect="coulomb_friction", hide="second", robot="panda", size=20.0)


def main(out: Path) -> None:
    """Make the study, diagnose it, keep the report's picture in fewer colours."""
    with TemporaryDirectory() as folder:
        study = Path(folder) / "panda"
        make_study(study, WORLD, Path(folder) / "truth")
        examination = sim2real.examine(study / "study.yaml")
        sim2real.write(Path(folder) / "report", examination, quick=True)
        png = (Path(folder) / "report" / "overview.png").read_bytes()
    with Image.open(io.BytesIO(png)) as image:
        image.convert("RGB").quantize(128).save(out, optimize=True)


if __name__ == "__main__":
    typer.run(main)
