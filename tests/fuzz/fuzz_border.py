"""Text and bytes at Python's border: a robot, hulls or pairs, or an error of ours and no other.

As bash tests/fuzz.sh does: .venv/bin/python tests/fuzz/fuzz_border.py CORPUS -max_total_time=60

The C++ readers have targets of their own; here it is what Python hands over: text, files, names
of links, and what is no text at all.
"""

import sys
import tempfile
import warnings
from pathlib import Path


def check_one_input(data: bytes) -> None:
    with tempfile.TemporaryDirectory(prefix="pdoik_fuzz_") as folder:
        check_in(Path(folder), data)


def check_in(folder: Path, data: bytes) -> None:
    import pdoik

    kind, content = (data[0], data[1:]) if data else (0, b"")
    name, _, body = content.partition(b"\n")
    source: str | Path
    if kind % 3 == 0:  # a file with any bytes
        source = folder / "file"
        source.write_bytes(body)
    else:
        source = body.decode("utf-8", "surrogateescape" if kind % 3 == 1 else "replace")
        # What is no text is a path: those of this machine are nothing to read here.
        if not any(mark in source for mark in "<\n{"):
            source = f"{folder}/" + source.replace("/", "")
    link = name.decode("utf-8", "surrogateescape" if kind & 64 else "replace") or None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", pdoik.RobotWarning)
            if kind & 8:
                occupancy = pdoik.Occupancy.load(source)
                assert pdoik.Occupancy.load(occupancy.to_yaml()) == occupancy, repr(occupancy)
            elif kind & 16:
                for pair in pdoik.load_srdf_pairs(source):
                    assert len(pair) == 2
            else:
                robot = pdoik.Robot.from_urdf(
                    source,
                    base_link=link if kind & 32 else None,
                    tip_link=link if kind & 128 else None,
                )
                repr(robot)
                assert len(robot.joint_names) == robot.dof == len(robot.lower)
    except (pdoik.LoadError, ValueError) as error:
        complaint = str(error)
        assert complaint
    except TypeError:  # a str that is no Unicode
        assert link is not None
        assert any("\ud800" <= character <= "\udfff" for character in link)


def main() -> None:
    import atheris

    with atheris.instrument_imports(include=["pdoik"]):
        import pdoik  # noqa: F401
    atheris.instrument_func(check_in)
    atheris.Setup(sys.argv, check_one_input)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
