"""XML files, and the numbers in them."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
import numpy.typing as npt

from pdoik.scenes.values import EntryError

FloatArray = npt.NDArray[np.float64]

_BEFORE = re.compile(rb"\A(?:\s|<!--.*?-->)+(?=<\?xml)", re.DOTALL)


def root_of(file: Path) -> Element:
    """The root of an XML file; comments may stand before its declaration, as Gazebo lets them.

    Raises:
        EntryError: It cannot be read, or is no XML.
    """
    try:
        return ElementTree.fromstring(_BEFORE.sub(b"", file.read_bytes(), count=1))
    except (OSError, ElementTree.ParseError, ValueError, LookupError) as error:
        raise EntryError(file, f"not XML: {error}") from error


def text_of(element: Element | None, tag: str, default: str = "") -> str:
    """The text of a child."""
    child = None if element is None else element.find(tag)
    return default if child is None else (child.text or "").strip()


def numbers_of(
    element: Element | None, tag: str, count: int, file: Path, entry: str, default: str = ""
) -> FloatArray:
    """As many finite numbers as a child's text is to hold, (count,).

    Raises:
        EntryError: They are not.
    """
    text = text_of(element, tag, default) or default
    try:
        values = np.array(text.split(), dtype=np.float64)
    except ValueError:
        values = np.empty(0)
    if values.shape != (count,) or not np.isfinite(values).all():
        raise EntryError(file, f"expected {count} numbers in <{tag}>, got {text!r}", entry)
    return values
