"""The report of a diagnosis: a page that loads nothing, says everything, is whole or absent."""

from __future__ import annotations

import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

pytest.importorskip("jinja2", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Diagnosis, Estimate, JointFit
from pdoik.sim2real.evidence import write_files
from pdoik.sim2real.report import (
    Pictures,
    RegimeMap,
    ReportData,
    binned,
    busiest,
    cloud_size,
    draw_pictures,
    drives_picture,
    envelope,
    house_style,
    joint_picture,
    reach,
    regime_map,
    render_report,
    words,  # inside: a page is held against its words
)
from pdoik.sim2real.report import page as html
from report_samples import JOINTS, diagnosis, evidence, traces

LARGEST = 8e6  # bytes of a page
VOID = {"meta", "br", "hr", "img", "link", "input"}
LOADS = {"src", "href", "xlink:href", "srcset", "data", "action", "poster"}


class Page(HTMLParser):
    """A page's words and what its elements point to; complains of tags that do not match."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.words: list[str] = []
        self.tags: list[str] = []
        self.pointers: list[str] = []
        self.ids: list[str] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.pointers += [value or "" for name, value in attributes if name in LOADS]
        self.ids += [value or "" for name, value in attributes if name == "id"]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if not (self.open and self.open[-1] == "style"):
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


@pytest.fixture(scope="module")
def data() -> ReportData:
    return evidence()


@pytest.fixture(scope="module")
def folder(data: ReportData, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("report") / "new" / "report"
    write_files(folder, render_report(diagnosis(data), data))
    return folder


@pytest.fixture(scope="module")
def page(folder: Path) -> Page:
    return Page((folder / "report.html").read_text())


def page_of(diagnosis: Diagnosis, data: ReportData) -> Page:
    return Page(str(render_report(diagnosis, data)["report.html"]))


def small(**changes: Any) -> ReportData:
    """Two joints, six seconds: quick to draw."""
    content: dict[str, Any] = {
        "title": "small",
        "joints": ("a", "b"),
        "units": ("N m", "N m"),
        "noise_floor": np.array([0.35, 0.40]),
        "recordings": (traces("run.csv", "validate", 0.0, 5, joints=2, seconds=6.0),),
    }
    return ReportData(**(content | changes))


@pytest.fixture(scope="module")
def small_pictures() -> tuple[ReportData, Pictures]:
    data = small()
    with house_style():
        return data, draw_pictures(diagnosis(data), data)


def test_the_page_loads_nothing_from_anywhere(folder: Path, page: Page) -> None:
    assert page.pointers
    for pointer in page.pointers:
        assert pointer.startswith(("#", "data:image/png;base64,")), pointer[:80]
    assert "script" not in page.tags
    text = (folder / "report.html").read_text()
    for address in re.findall(r"url\(([^)]*)\)", text):
        assert address.startswith("#"), address
    assert "@import" not in text
    assert {"link", "iframe", "object", "img"}.isdisjoint(page.tags)


def test_what_changes_from_session_to_session_is_said(
    small_pictures: tuple[ReportData, Pictures],
) -> None:
    data, pictures = small_pictures
    found = diagnosis(data)
    rubs = next(each for each in found.findings if each.effect == "coulomb_friction")
    level = replace(rubs.parameters["level"], spread=0.25, spread_p=1e-4)
    for p, said in ((1e-4, True), (0.3, False)):
        changed = replace(rubs, parameters={"level": replace(level, spread_p=p)})
        text = Page(html(replace(found, findings=(changed,)), data, pictures)).text
        assert ("Changes from session to session level by 12 %" in text) == said
        assert ("Coulomb friction changes (level): elbow by 12 %." in text) == said


def test_ids_are_unique_and_links_within_the_page_arrive(page: Page) -> None:
    assert len(set(page.ids)) == len(page.ids)
    assert {pointer[1:] for pointer in page.pointers if pointer.startswith("#")} <= set(page.ids)


def test_the_page_says_every_finding_with_its_numbers(data: ReportData, page: Page) -> None:
    found = diagnosis(data)
    assert words.VERDICTS[found.verdict][0] in page.text
    for finding in found.findings:
        for said in (finding.statement, finding.regime, finding.decided_by):
            assert said in page.text
        assert words.percent(finding.evidence.validation_gain) in page.text
        for name, estimate in finding.parameters.items():
            assert name in page.text
            value, low, high = words.estimate_numbers(estimate)
            assert value in page.text
            assert f"{low} to {high}" in page.text
        for other in finding.equivalents:
            assert words.effect_name(other.effect) in page.text
    for name, fit in found.joints.items():
        row = " ".join((name, *map(words.number, (fit.before, fit.after, fit.noise_floor))))
        assert row in page.text
    for tried in data.hypotheses:
        assert tried.reason in page.text
    for note in (*found.notes, *data.notes):
        assert note in page.text


def test_findings_stand_in_their_order(data: ReportData, page: Page) -> None:
    places = [page.text.index(finding.statement) for finding in diagnosis(data).findings]
    assert places == sorted(places)


def test_pictures_are_pictures_and_stand_in_the_page_too(folder: Path, page: Page) -> None:
    pictures = sorted((folder / "figures").glob("*.png"))
    assert {"joints", "regimes", "hypotheses", "cutoff"} <= {path.stem for path in pictures}
    for joint in JOINTS:
        assert any(joint in path.stem for path in pictures)
    for path in pictures:
        assert f"fig-{path.stem}" in page.ids
    for path in [*pictures, folder / "overview.png"]:
        with Image.open(path) as image:
            pixels = np.asarray(image.convert("RGB"), dtype=float)
        assert min(pixels.shape[:2]) > 150
        assert pixels.std() > 10
        assert (pixels == 255).all(axis=2).mean() < 0.98


def test_names_of_the_user_are_words_and_not_markup() -> None:
    nasty = "<script>alert('$x_1$')</script>&\"kg"
    data = small(
        title=nasty,
        joints=(nasty, "b"),
        notes=(nasty,),
        recordings=(replace(traces("r", "fit", 0, 5, joints=2, seconds=6.0), name=nasty),),
    )
    found = diagnosis(data)
    finding = replace(
        found.findings[1], joints=(nasty,), statement=nasty, regime=nasty, decided_by=nasty
    )
    found = replace(found, findings=(finding,), notes=(nasty,))
    page = page_of(found, data)
    assert "script" not in page.tags
    assert page.text.count(nasty) >= 6


def test_glyphs_that_no_font_has_do_not_stop_it() -> None:
    data = small(joints=("関節一", "b"))
    assert "関節一" in page_of(diagnosis(data), data).text


def test_files_stay_inside_the_folder_whatever_names_say(tmp_path: Path) -> None:
    data = small(joints=("../../a", "/etc/b"))
    write_files(tmp_path / "out", render_report(diagnosis(data), data))
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_what_a_drive_does_not_exceed_is_drawn_over_speed(
    small_pictures: tuple[ReportData, Pictures],
) -> None:
    data, pictures = small_pictures
    assert pictures.drives is None
    found = diagnosis(data)
    figures = {"stall_torque": (20.0, "N m"), "no_load_speed": (2.0, "rad/s")}
    limit = replace(
        found.findings[0],
        effect="torque_speed_limit",
        joints=("b",),
        parameters={
            name: Estimate(value=value, std=0.1, interval95=(value - 0.2, value + 0.2), unit=unit)
            for name, (value, unit) in figures.items()
        },
    )
    with house_style():
        drawn = drives_picture(replace(found, findings=(limit,)), data)
        drawn_of_currents = drives_picture(
            replace(found, findings=(limit,)), replace(data, residual_of="current")
        )
    assert drawn is not None
    assert "over speed" in drawn.caption
    assert "limit" in drawn.svg
    assert drawn_of_currents is None
    text = html(found, data, replace(pictures, drives=drawn))
    assert "drives" in Page(text).ids


def test_seven_joints_and_three_recordings_stay_small() -> None:
    names = tuple(f"joint{k}" for k in range(1, 8))
    recordings = tuple(
        traces(f"{role}.csv", role, 60.0 * k, k, joints=7)
        for k, role in enumerate(("fit", "fit", "validate"))
    )
    data = small(
        joints=names, units=("N m",) * 7, noise_floor=np.full(7, 0.3), recordings=recordings
    )
    files = render_report(diagnosis(data), data)
    assert len(str(files["report.html"])) < LARGEST / 2


def test_the_joints_of_a_humanoid_stay_small_together() -> None:
    n = 30
    run = traces("run.csv", "validate", 0.0, 1, joints=1)
    data = small(joints=("a",), units=("N m",), noise_floor=np.array([0.3]), recordings=(run,) * 3)
    with house_style():
        assert n * len(joint_picture(data, 0, cloud_size(n)).svg) < 0.9 * LARGEST


@pytest.mark.parametrize("verdict", list(words.VERDICTS))
def test_every_verdict_has_its_page_without_findings(
    verdict: Any, small_pictures: tuple[ReportData, Pictures]
) -> None:
    data, pictures = small_pictures
    page = Page(html(diagnosis(data, verdict=verdict, findings=()), data, pictures))
    assert words.VERDICTS[verdict][0] in page.text
    assert "findings" not in page.ids


def test_what_was_not_recorded_leaves_gaps_and_no_numbers() -> None:
    run = traces("run.csv", "validate", 0.0, 5, joints=2, seconds=6.0)
    for name in ("q", "dq", "load", "before", "after"):
        getattr(run, name)[:, 1] = np.nan
    data = small(recordings=(run,), noise_floor=np.array([0.35, np.nan]))
    nothing = JointFit(
        before=np.nan, after=np.nan, noise_floor=np.nan, unit="N m", data="-", excited=False
    )
    found = diagnosis(data, findings=())
    page = page_of(replace(found, joints={**found.joints, "b": nothing}), data)
    assert "not moved enough to judge" in page.text
    assert re.search(r"\bnan\b", page.text, re.IGNORECASE) is None


def test_the_same_input_gives_the_same_files() -> None:
    data = small()
    found = diagnosis(data)
    assert render_report(found, data) == render_report(found, data)


def test_without_a_recording_nothing_is_shown() -> None:
    with pytest.raises(ValueError, match=r"evidence\.recordings is empty"):
        render_report(diagnosis(small()), small(recordings=()))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"units": ("N m",)}, "units has 1 entries, the study has 2 joints"),
        ({"noise_floor": np.zeros(3)}, r"noise_floor has shape \(3,\), expected \(2\)"),
        (
            {"recordings": (traces("r.csv", "fit", 0.0, 1, joints=3, seconds=1.0),)},
            r"q of r\.csv has shape \(125, 3\), expected \(125, 2\)",
        ),
    ],
)
def test_arrays_of_the_wrong_shape_are_named(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        small(**changes)


def test_friction_sits_in_one_direction_and_a_payload_where_the_arm_is_stretched() -> None:
    run = traces("run.csv", "validate", 0.0, 5, joints=2)
    run.before[:, 0] = np.where(run.dq[:, 0] > 0, 3.0, 0.1)
    run.before[:, 1] = np.where(np.abs(run.load[:, 1]) > 30, 2.0, 0.0)
    regimes = regime_map(small(recordings=(run,)))
    share = {bin_: regimes.share[:, k] for k, bin_ in enumerate(regimes.bins)}
    assert share["direction", "forwards"][0] > 0.8
    assert share["load", "heavy"][1] > 0.8
    for quantity in {quantity for quantity, _ in regimes.bins}:
        total = sum(values for (name, _), values in share.items() if name == quantity)
        assert np.all(np.isclose(total, 1.0) | (total == 0))


def test_a_map_given_is_the_map_shown() -> None:
    share = np.array([[1.0, 0.0], [0.25, 0.75]])
    given = RegimeMap(bins=(("mood", "glum"), ("mood", "gay")), share=share)
    data = small(regimes=given)
    text = page_of(diagnosis(data), data).text
    assert "glum" in text
    assert "75 %" in text


def test_an_envelope_keeps_every_spike(rng: np.random.Generator) -> None:
    x = np.arange(100_000.0)
    y = rng.normal(size=len(x))
    y[12_345], y[77_777] = 40.0, -30.0
    small_x, small_y = envelope(x, y)
    assert len(small_x) == len(small_y) < 2000
    assert small_y.max() == 40.0
    assert small_y.min() == -30.0
    assert np.all(np.diff(small_x) >= 0)


def test_bins_find_a_curve_among_noise_and_gaps(rng: np.random.Generator) -> None:
    x = rng.uniform(-1, 1, 20_000)
    y = np.sin(3 * x) + rng.normal(0, 0.1, len(x))
    y[::7] = np.nan
    bins = binned(x, y)
    assert len(bins.x) > 10
    np.testing.assert_allclose(bins.median, np.sin(3 * bins.x), atol=0.03)
    assert np.all((bins.low < bins.median) & (bins.median < bins.high))
    assert len(binned(np.full(100, 2.0), y[:100]).x) == 0


def test_the_busiest_stretch_is_where_the_values_are() -> None:
    time = np.arange(0, 60, 0.01)
    values = np.where((time > 31) & (time < 34), 5.0, 0.1)
    part = busiest(time, values, 6.0)
    assert time[part][0] <= 31
    assert time[part][-1] >= 33.9
    low, high = reach(values)
    assert low < 0 < 5.0 < high


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1.2345, "1.23"),
        (-0.01234, "\N{MINUS SIGN}0.0123"),
        (98765.4, "98765"),
        (1.5e-7, "1.50e\N{MINUS SIGN}7"),
        (float("nan"), "\N{EN DASH}"),
    ],
)
def test_numbers_read_well(value: float, text: str) -> None:
    assert words.number(value) == text
