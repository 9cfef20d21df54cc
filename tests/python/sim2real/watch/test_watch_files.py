"""pdoik watch: logs that are read while they are written."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

from command_line import misuse, run
from pdoik.errors import LoadError
from pdoik.sim2real import model_of
from pdoik.sim2real.watch import CsvStream, Folder, Tail
from watched import Columns, changed, log

Opened = Callable[[Any], Any]
JOINTS = ("a", "b")
HEADER = "time,q.a,q.b,tau.a,tau.b,dq.a\n"


def lines(first: int, last: int) -> str:
    return "".join(f"{0.01 * k:.2f},{k},{-k},{2 * k},0.5,9\n" for k in range(first, last))


def times(pieces: Any) -> list[float | None]:
    """Times of all rows, None where another clock may begin."""
    found: list[float | None] = []
    for _, columns in pieces:
        found += [None] if columns is None else columns["time"].tolist()
    return found


def numbers(first: int, last: int) -> list[float]:
    return [round(0.01 * k, 2) for k in range(first, last)]


@pytest.fixture
def opened() -> Iterator[Opened]:
    """What it is given is closed at the end."""
    with ExitStack() as stack:
        yield lambda each: stack.enter_context(closing(each))


def test_a_half_written_line_waits_for_its_rest(tmp_path: Path, opened: Opened) -> None:
    path = tmp_path / "log.csv"
    tail = opened(Tail(path, JOINTS))
    assert times(tail.read()) == []  # it is not there yet
    whole = HEADER + lines(0, 20)
    read: list[float | None] = []
    with path.open("w") as file:
        for at in range(0, len(whole), 7):
            file.write(whole[at : at + 7])
            file.flush()
            read += times(tail.read())
    assert read == numbers(0, 20)


def test_all_rows_come_while_another_thread_writes_them(tmp_path: Path, opened: Opened) -> None:
    path = tmp_path / "log.csv"

    def write() -> None:
        text = HEADER + lines(0, 3000)
        with path.open("w") as file:
            for at in range(0, len(text), 777):
                file.write(text[at : at + 777])
                file.flush()
                time.sleep(0.001)

    writer = threading.Thread(target=write)
    writer.start()
    tail, read = opened(Tail(path, JOINTS)), []
    while writer.is_alive():
        read += times(tail.read())
    writer.join()
    read += times(tail.read())
    assert read == numbers(0, 3000)


def test_a_log_that_is_renamed_loses_no_row_and_its_successor_is_read(
    tmp_path: Path, opened: Opened
) -> None:
    path = tmp_path / "log.csv"
    path.write_text(HEADER + lines(0, 10))
    tail = opened(Tail(path, JOINTS))
    assert times(tail.read()) == numbers(0, 10)
    with path.open("a") as file:
        file.write(lines(10, 15))
    path.rename(tmp_path / "log.csv.1")
    assert times(tail.read()) == numbers(10, 15)
    path.write_text(lines(0, 5))  # some loggers write no second header
    assert times(tail.read()) == [None, *numbers(0, 5)]


def test_a_log_that_is_cut_off_begins_anew(tmp_path: Path, opened: Opened) -> None:
    path = tmp_path / "log.csv"
    path.write_text(HEADER + lines(0, 100))
    tail = opened(Tail(path, JOINTS))
    assert times(tail.read()) == numbers(0, 100)
    path.write_text(HEADER + lines(50, 60))
    assert times(tail.read()) == [None, *numbers(50, 60)]


def test_a_folder_goes_on_to_newer_files(tmp_path: Path, opened: Opened) -> None:
    folder = opened(Folder(tmp_path, JOINTS))
    assert times(folder.read()) == []
    (tmp_path / "1.csv").write_text(HEADER + lines(0, 5))
    os.utime(tmp_path / "1.csv", (1, 1))
    (tmp_path / "notes.md").write_text("no log")
    assert times(folder.read()) == numbers(0, 5)
    (tmp_path / "2.csv").write_text(HEADER + lines(0, 3))
    assert times(folder.read()) == [None, *numbers(0, 3)]
    with (tmp_path / "2.csv").open("a") as file:
        file.write(lines(3, 6))
    assert times(folder.read()) == numbers(3, 6)


def test_torn_lines_are_left_out_and_nonsense_is_said() -> None:
    stream = CsvStream("log.csv", JOINTS)
    text = HEADER + lines(0, 40) + "0.4,1,x,3,4,5\n0.4,1\n" + lines(41, 60)
    (columns,) = stream.add(text.encode())
    assert columns["time"].tolist() == [*numbers(0, 40), *numbers(41, 60)]
    assert stream.torn >= 1
    with pytest.raises(LoadError, match="hold something else than numbers"):
        list(stream.add(b"a,b,c,d,e,f\n" * 10))
    with pytest.raises(LoadError, match=r"expected a column 'tau\.b'"):
        list(CsvStream("log.csv", JOINTS).add(b"time,q.a,q.b,tau.a,heat_b\n0,0,0,0,0\n"))
    with pytest.raises(LoadError, match="the first line holds numbers"):
        list(CsvStream("log.csv", JOINTS).add(b"0,0,0,0,0\n1,0,0,0,0\n"))


def test_columns_are_understood_by_their_words_and_units() -> None:
    text = b"t [ms],a_position_deg,b/pos,effort_a,tau_b [mNm]\n500,180,2,3,4000\n"
    (columns,) = CsvStream("log.csv", JOINTS).add(text)
    assert {name: float(values[0]) for name, values in columns.items()} == pytest.approx(
        {"time": 0.5, "q.a": np.pi, "q.b": 2.0, "tau.a": 3.0, "tau.b": 4.0}
    )


def test_a_decimal_comma_is_understood() -> None:
    stream = CsvStream("log.csv", JOINTS)
    text = "time;q.a;q.b;tau.a;tau.b\n0,5;1,25;0;0;-2,5\n0,6;1,5;0;0;-3\n"
    (columns,) = stream.add(text.encode())
    assert columns["q.a"].tolist() == [1.25, 1.5]
    assert columns["tau.b"].tolist() == [-2.5, -3.0]


@pytest.fixture(scope="module")
def model(examination: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return model_of(examination).save(tmp_path_factory.mktemp("watched"))


def write(path: Path, columns: Columns) -> Path:
    header = ",".join(columns)
    values = np.column_stack(list(columns.values()))
    np.savetxt(path, values, fmt="%.7g", delimiter=",", header=header, comments="")
    return path


def test_the_command_tells_of_a_change_and_its_status_says_so(model: Path, tmp_path: Path) -> None:
    columns = {k: v for k, v in log(11, 60.0).items() if "des" not in k}
    healthy = write(tmp_path / "healthy.csv", columns)
    assert run("watch", model, healthy, "--once").exit_code == 0
    path = write(tmp_path / "changed.csv", changed(columns, "offset", "base", 12.0))
    output = tmp_path / "alarms.jsonl"
    invocation = run("watch", model, healthy, path, "--once", "--out", output)
    assert invocation.exit_code == 3, invocation.output
    said = invocation.stdout.splitlines()
    alarms = [json.loads(line) for line in output.read_text().splitlines()]
    assert [each["stage"] for each in alarms] == ["noticed", "learnt"]
    assert len(said) == 2
    assert "base" in said[0]
    assert "torque offset at base: offset +0." in said[1]
    assert alarms[1]["causes"][0]["change"]["offset"]["value"] == pytest.approx(0.5, abs=0.05)
    calibrated = run("watch", model, path, "--once", "--calibrate", healthy)
    assert calibrated.exit_code == 3, calibrated.output


def test_standard_input_is_watched(model: Path, tmp_path: Path) -> None:
    columns = {k: v[:3000] for k, v in log(11, 60.0).items() if "des" not in k}
    path = write(tmp_path / "changed.csv", changed(columns, "offset", "base", 12.0))
    command = [sys.executable, "-m", "pdoik.cli", "watch", str(model), "-", "--once"]
    with path.open("rb") as file:
        done = subprocess.run(command, stdin=file, capture_output=True, text=True, check=False)
    assert done.returncode == 3, done.stderr
    assert "torque offset at base" in done.stdout


def test_misuse_is_said(model: Path, tmp_path: Path) -> None:
    misuse(run("watch", model, tmp_path / "none.csv"), "no such file")
    misuse(run("watch", model, tmp_path, model), "watched alone")
    path = write(tmp_path / "log.csv", {"time": np.arange(9.0), "q.base": np.zeros(9)})
    misuse(run("watch", model, path, "--once"), "expected a column")
    misuse(run("watch", model, path, "--out", path), "is also read")
