"""The Python reference: every public name is on one page, and in the index of these pages."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import pdoik
import pdoik.recordings

DOCS = Path(__file__).parents[3] / "python" / "docs"
INDEX = (DOCS / "api.md").read_text()
PAGES = sorted((DOCS / "api").glob("*.md"))


def described(page: Path) -> list[str]:
    """The names that a page describes."""
    return re.findall(r"^\.\. (?:auto\w+|data):: (\S+)$", page.read_text(), re.MULTILINE)


def sections() -> dict[str, str]:
    """Of the index, by title."""
    parts = re.split(r"^## (.+)\n", INDEX, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def test_every_public_name_is_on_one_page() -> None:
    """The build of the site fails on a name there that does not exist."""
    sim2real = pytest.importorskip("pdoik.sim2real", reason="the extra sim2real is not installed")
    public = [f"pdoik.{name}" for name in pdoik.__all__ if not name.startswith("__")]
    public += [f"pdoik.sim2real.{name}" for name in sim2real.__all__]
    names = [name for page in PAGES for name in described(page)]
    of_logs = [name for name in names if name.startswith("pdoik.recordings.")]
    assert sorted(set(names) - set(of_logs)) == sorted(public)
    assert len(names) == len(set(names))
    # Its face has besides what pdoik's own packages share.
    assert set(of_logs) <= {f"pdoik.recordings.{name}" for name in pdoik.recordings.__all__}


def test_the_index_has_a_section_for_each_page_with_its_names() -> None:
    assert len(sections()) == len(PAGES)
    linked = []
    for title, text in sections().items():
        page = DOCS / re.findall(r"\]\((api/\w+\.md)\)", text)[0]
        linked.append(page.stem)
        assert page.read_text().startswith(f"# {title}\n")
        listed = re.findall(r"^(?:   |{py:data}`)(pdoik\.[\w.]+)", text, re.MULTILINE)
        assert listed == described(page)
    assert sorted(linked) == [page.stem for page in PAGES]
    assert re.findall(r"^api/(\w+)$", INDEX, re.MULTILINE) == linked


def test_sections_that_were_in_the_reference_when_it_was_one_page_are_still_in_it() -> None:
    """Addresses of names on it are led on by static/old_addresses.js."""
    assert set(sections()) >= {
        *("Robots", "Solving", "Obstacles", "Reports and errors", "Diagnosis", "Studies"),
        *("The stages of a diagnosis", "What follows from a diagnosis", "Your own effects"),
    }
