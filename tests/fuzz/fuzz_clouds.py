"""Bytes as a point cloud of any format that pdoik reads: finite points (N, 3), or LoadError.

As bash tests/fuzz.sh does: .venv/bin/python tests/fuzz/fuzz_clouds.py CORPUS -max_total_time=60

The first byte of an input chooses the suffix, the rest is the file.
"""

import sys
import tempfile
import warnings
from pathlib import Path

import numpy as np

SUFFIXES = (".pcd", ".ply", ".npy", ".xyz", ".csv")


def check_one_input(data: bytes) -> None:
    with tempfile.TemporaryDirectory(prefix="pdoik_fuzz_") as folder:
        check_in(Path(folder), data)


def check_in(folder: Path, data: bytes) -> None:
    from pdoik.clouds import load_cloud
    from pdoik.errors import LoadError

    path = folder / ("cloud" + SUFFIXES[data[0] % len(SUFFIXES) if data else 0])
    path.write_bytes(data[1:])
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            points = load_cloud(path)
        except LoadError as error:
            complaint = str(error)
            assert str(path) in complaint
            return
    assert points.dtype == np.float64
    assert points.ndim == 2
    assert points.shape[1] == 3
    assert len(points) > 0
    assert points.flags.c_contiguous
    assert np.isfinite(points).all()
    assert len(points) <= len(data), "more points than bytes"
    assert not said, f"what is read without an error is read without a word: {said[0].message}"


def main() -> None:
    import atheris

    with atheris.instrument_imports(include=["pypcd4", "pdoik._ply", "pdoik.clouds"]):
        import pypcd4.pypcd4  # noqa: F401

        import pdoik.clouds  # noqa: F401
    import logging

    logging.disable(logging.CRITICAL)
    atheris.instrument_func(check_in)
    atheris.Setup(sys.argv, check_one_input)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
