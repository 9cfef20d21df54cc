"""Encoders that wrap are unwrapped; what a joint may do stays as it is, to the bit."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from command_line import run
from pdoik.errors import LoadError
from pdoik.recordings import (
    Table,
    Units,
    joints_of,
    read_log,
    units_from,
    with_jumps_mended,
)
from pdoik.sim2real.study import load_study
from studies import log, write_study

BESIDE = Path(__file__).resolve().parents[4] / "shared"
RECORDINGS = Path(os.environ.get("PDOIK_SHARED", BESIDE)) / "recordings"
TURN = 2.0 * np.pi
TIME = np.arange(0.0, 30.0, 0.01)


def table(time: np.ndarray, q: np.ndarray, **others: np.ndarray) -> Table:
    """A log of joint j."""
    columns = {"q.j": q, **{f"{channel}.j": values for channel, values in others.items()}}
    return Table(name="a.csv", start=0.0, time=time, columns=columns)


def mended(read: Table, *, units: Units | None = None, slides: bool = False) -> Table:
    return with_jumps_mended(read, ("j",), units or Units(), ("j",) if slides else ())


def wrapped(q: np.ndarray, size: float, low: float | None = None) -> np.ndarray:
    """What an encoder reads that goes from `low` to `low` + size, by default about zero."""
    start = -0.5 * size if low is None else low
    return np.asarray(np.mod(q - start, size) + start)


def swings(time: np.ndarray, size: float) -> np.ndarray:
    """Motion to and fro over about five times the size, with rests at its ends."""
    return np.asarray(2.5 * size * np.sin(0.4 * time + 0.3 * np.sin(0.4 * time)) + 0.1)


@pytest.mark.parametrize("size", [TURN, 25.13, 25.0, 3.0], ids=lambda size: f"{size:.4g}")
@pytest.mark.parametrize("noise", [0.0, 1e-3])
@pytest.mark.parametrize("known", ["dq", "q alone"])
@pytest.mark.parametrize("rate", [20.0, 100.0, 1000.0])
def test_what_wraps_is_as_it_was_before(size: float, noise: float, known: str, rate: float) -> None:
    rng = np.random.default_rng(int(size * rate))
    time = np.arange(0.0, 30.0, 1.0 / rate)
    true = swings(time, size) + noise * rng.standard_normal(len(time))
    read = wrapped(true, size)
    others = {"dq": np.gradient(swings(time, size), time)} if known == "dq" else {}
    made = mended(table(time, read, **others), slides=size == 3.0)
    error = made.columns["q.j"] - true
    count = int((np.abs(np.diff(read)) > 0.5 * size).sum())
    assert count >= 15
    assert np.ptp(error) < 0.01 * size
    assert np.abs(np.diff(error)).max() < 0.005 * size
    (note,) = made.notes
    words = note.split()
    assert words[:2] == ["q.j", "jumps"]
    assert int(words[2]) == count if noise == 0.0 else 15 <= int(words[2]) <= count
    assert abs(float(words[5]) - size) < 2e-3 * size
    assert words[6] == ("m," if size == 3.0 else "rad,")
    assert note.endswith("where its encoder wraps; it was unwrapped")
    for name in others:
        assert made.columns[f"{name}.j"] is others[name]


@pytest.mark.parametrize("low", [-np.pi, 0.0])
def test_angles_within_a_turn_are_unwrapped_by_turns_exactly(low: float) -> None:
    true = np.round(6.0 * TIME + 0.5 * np.sin(TIME), 4)
    made = mended(table(TIME, np.round(wrapped(true, TURN, low), 4)))
    turns = (made.columns["q.j"] - true) / TURN
    assert np.abs(turns - np.rint(turns[0])).max() < 1e-4
    assert "by 6.283 rad" in made.notes[0]


def test_one_wrap_is_enough_where_the_joint_goes_through_it() -> None:
    time = TIME[:500]
    true = 11.0 + 4.0 * np.sin(0.3 * time)
    made = mended(table(time, wrapped(true, 25.0)))
    assert np.ptp(made.columns["q.j"] - true) < 1e-3
    assert made.notes[0].startswith("q.j jumps once by 25 rad")


def test_a_joint_that_trembles_at_the_end_of_the_range_is_unwrapped() -> None:
    rng = np.random.default_rng(3)
    true = 12.5 + 6.0 * np.clip(TIME - 20.0, 0.0, 1.0) - 6.0 * np.clip(5.0 - TIME, 0.0, 1.0)
    true = true + 2e-3 * rng.standard_normal(len(TIME))
    read = wrapped(true, 25.0)
    assert (np.abs(np.diff(read)) > 20.0).sum() > 50
    assert np.ptp(mended(table(TIME, read)).columns["q.j"] - true) < 0.05


def test_multiples_of_a_turn_are_turns_that_were_counted_wrongly() -> None:
    true = np.sin(TIME)
    read = true + TURN * (1.0 * (TIME > 5.0) + 2.0 * (TIME > 12.0) - 1.0 * (TIME > 21.0))
    made = mended(table(TIME, read))
    assert np.abs(made.columns["q.j"] - true).max() < 1e-9
    assert made.notes[0].startswith("q.j jumps 3 times by 6.283 rad or multiples of it")
    assert mended(table(TIME, read), slides=True).notes[0].endswith("left out within 0.25 s")


def test_glitches_and_lost_rows_do_not_hide_a_wrap() -> None:
    true = swings(TIME, 25.0)
    read = wrapped(true, 25.0)
    read[[700, 701, 2203]] += 3.0
    kept = np.ones(len(TIME), dtype=bool)
    kept[np.random.default_rng(5).choice(len(TIME), 150, replace=False)] = False
    kept[np.flatnonzero(np.abs(np.diff(read)) > 20.0)[2] + np.arange(-4, 8)] = False  # a gap
    made = mended(table(TIME[kept], read[kept]))
    error = made.columns["q.j"] - true[kept]
    assert np.ptp(np.delete(error, np.flatnonzero(np.abs(error - np.median(error)) > 2.9))) < 0.1
    assert (np.abs(error - np.median(error)) > 2.9).sum() <= 3


def test_degrees_wrap_at_360() -> None:
    units = units_from({"q": "deg"}, "study.yaml")
    made = mended(table(TIME, np.rad2deg(wrapped(5.0 * TIME, TURN))), units=units)
    assert np.ptp(made.columns["q.j"] - np.rad2deg(5.0 * TIME)) < 1e-6
    assert "by 6.283 rad" in made.notes[0]


def test_a_command_is_unwrapped_by_its_own_jumps() -> None:
    true, ahead = swings(TIME, TURN), swings(TIME + 0.15, TURN)
    read = wrapped(true, TURN)
    made = mended(table(TIME, read, q_des=wrapped(ahead, TURN)))
    assert np.abs(made.columns["q_des.j"] - made.columns["q.j"] - (ahead - true)).max() < 1e-9
    assert made.notes[1] == "q_des.j wraps as q.j does; it was unwrapped by itself"
    made = mended(table(TIME, read, q_des=ahead))
    assert np.array_equal(made.columns["q_des.j"], ahead)
    assert len(made.notes) == 1


def test_a_command_that_jumps_alone_is_as_it_was() -> None:
    jumping = wrapped(swings(TIME, 0.5), 0.5)
    for read in (
        table(TIME, swings(TIME, 0.5), q_des=jumping),
        table(TIME, jumping, q_des=jumping),  # only commands are known
    ):
        assert mended(read) is read


def rests(time: np.ndarray, length: float, far: float = 1.0) -> np.ndarray:
    """There and back between rests, each way within `length` seconds."""
    phase = np.clip((time % 3.0 - 0.5) / length, 0.0, 1.0)
    back = np.clip((time % 3.0 - 2.0) / length, 0.0, 1.0)
    return np.asarray(far * (phase**2 * (3.0 - 2.0 * phase) - back**2 * (3.0 - 2.0 * back)))


def lifts_and_drops(time: np.ndarray) -> np.ndarray:
    """Slowly up, down within a tenth of a second."""
    phase = time % 4.0
    return np.asarray(np.minimum(phase, 3.9) / 3.9 * np.clip((4.0 - phase) / 0.1, 0.0, 1.0))


ORDINARY: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "waves": lambda t: np.sin(3.0 * t),
    "fast waves": lambda t: np.sin(2.0 * np.pi * 1.9 * t),
    "slow waves in steps of an encoder": lambda t: np.rint(np.sin(0.2 * t) / 1.5e-3) * 1.5e-3,
    "a wheel": lambda t: 15.0 * t,
    "moves": lambda t: rests(t, 0.5),
    "quick moves": lambda t: rests(t, 0.08),
    "moves by a turn": lambda t: rests(t, 0.3, TURN),
    "lifts and drops": lifts_and_drops,
    "stands": lambda t: np.full(len(t), 0.3),
    "stands, with noise": lambda t: 1e-4 * np.random.default_rng(1).standard_normal(len(t)),
    "two places": lambda t: 0.2 * np.sign(np.sin(2.0 * t)),
    "sticks and slips": lambda t: np.floor(0.3 * t / 0.01) * 0.01,
}


@pytest.mark.parametrize("name", ORDINARY)
@pytest.mark.parametrize("rate", [4.0, 10.0, 50.0, 500.0])
@pytest.mark.parametrize("slides", [False, True], ids=["turns", "slides"])
def test_ordinary_motion_stays_as_it_was(name: str, rate: float, slides: bool) -> None:
    time = np.arange(0.0, 40.0, 1.0 / rate)
    q = ORDINARY[name](time)
    read = table(time, q)
    assert mended(read, slides=slides) is read
    read = table(time, q, dq=np.gradient(q, time), q_des=q + 1e-3)
    assert mended(read, slides=slides) is read
    held = table(time, q[np.arange(len(q)) // 4 * 4])
    assert mended(held, slides=slides) is held


@pytest.mark.parametrize("far", [0.3, TURN, 25.0])
def test_a_joint_that_is_elsewhere_after_a_gap_does_not_wrap(far: float) -> None:
    q = np.sin(TIME) + far * (TIME > 9.0) + far * (TIME > 15.0)
    kept = (np.abs(TIME - 9.0) > 0.1) & (np.abs(TIME - 15.0) > 2.0)
    read = table(TIME[kept], q[kept])
    assert mended(read) is read


def test_a_recording_without_jumps_is_read_to_the_bit(tmp_path: Path) -> None:
    made = load_study(write_study(tmp_path, {"a.csv": log(), "b.csv": log()})).fit[0]
    assert np.array_equal(made.q, log()[["q.shoulder", "q.elbow"]])
    assert not made.notes


def test_a_jump_that_is_no_wrap_is_told_and_left_out(tmp_path: Path) -> None:
    slipped = log()
    slipped.loc[slipped["time"] > 4.0, "q.elbow"] += 0.7
    study = load_study(write_study(tmp_path, {"a.csv": slipped, "b.csv": log()}))
    made = study.fit[0]
    (told,) = [note for note in made.notes if "jump" in note]
    assert "q.elbow jumps once by 0.7" in told
    assert "at 4.010 s" in told
    out = np.abs(made.time - 4.005) < 0.2
    assert not made.valid[out].any()
    assert made.valid[np.abs(made.time - 4.005) > 0.3].all()
    assert np.array_equal(made.q[made.valid], slipped[["q.shoulder", "q.elbow"]][made.valid])


def test_jumps_of_all_sizes_are_refused_by_name_and_time(tmp_path: Path) -> None:
    rng = np.random.default_rng(7)
    jumping = log()
    for at in np.arange(0.6, 7.9, 0.45):
        jumping.loc[jumping["time"] > at, "q.elbow"] += rng.choice([-1, 1]) * rng.uniform(0.4, 1.0)
    with pytest.raises(LoadError, match=r"a\.csv: q\.elbow jumps 1\d times by 0\.\d+ to .* rad"):
        load_study(write_study(tmp_path, {"a.csv": jumping, "b.csv": log()}))
    with pytest.raises(LoadError, match=r"\(at 0\.610, 1\.060, "):
        load_study(write_study(tmp_path, {"a.csv": jumping, "b.csv": log()}))


def shared(folder: str) -> Path:
    path = RECORDINGS / folder
    if not path.is_dir():
        pytest.skip(f"needs recordings/{folder} from the shared material (PDOIK_SHARED)")
    return path


def test_a_real_drive_is_unwrapped_and_it_is_said() -> None:
    study = load_study(shared("strangers/wrapped_encoder") / "study.yaml")
    assert len(study.recordings) == 3
    for made in study.recordings:
        assert "q.joint1 jumps 8 times by 25 rad, where its encoder wraps; it was unwrapped" in (
            made.notes
        )
        assert np.abs(np.diff(made.q[:, 0])).max() < 1.0
        assert made.valid.all()
        # The drive's own speed, which this log holds in half its unit, goes along throughout.
        assert made.dq is not None
        rate = np.gradient(made.q[:, 0], made.period)
        assert np.corrcoef(rate, made.dq[:, 0])[0, 1] > 0.99


def test_study_check_tells_of_a_real_drive_that_it_wraps() -> None:
    pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
    checked = run("study", "check", shared("strangers/wrapped_encoder") / "study.yaml")
    assert checked.exit_code == 0, checked.output
    said = " ".join(checked.output.split())
    for name in ("rec1", "rec2", "rec3"):
        assert f"{name}.csv: q.joint1 jumps 8 times by 25 rad, where its encoder wraps" in said


@pytest.mark.parametrize(
    "folder",
    [
        "strangers/poor_serial_log",
        "strangers/arm_on_its_side",
        "strangers/cable_at_a_wrist",
        "bam_xl330",
        "dfki_double_pendulum",
        "go2_hanging",
        "panda_unisa",
        "so101_sage",
        "ur10_unisa",
    ],
)
@pytest.mark.parametrize("speed", [True, False], ids=["dq", "q alone"])
@pytest.mark.parametrize("every", [1, 20])
def test_real_recordings_that_do_not_wrap_stay_as_they_were(
    folder: str, speed: bool, every: int
) -> None:
    for path in sorted(shared(folder).glob("*.csv")):
        read = read_log(path, every=every, numbered=False).table
        joints = joints_of(read.columns)
        columns = {k: v for k, v in read.columns.items() if speed or not k.startswith("dq.")}
        again = (np.diff(read.time) > 0.0).nonzero()[0] + 1
        rising = np.concatenate([[0], again])
        read = Table(
            name=read.name,
            start=read.start,
            time=read.time[rising],
            columns={name: values[rising] for name, values in columns.items()},
        )
        if len(rising) >= 50:
            assert with_jumps_mended(read, joints, Units(), ()) is read, path.name
