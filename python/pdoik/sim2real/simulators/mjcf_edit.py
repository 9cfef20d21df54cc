"""MJCF as text: start tags by their places, attributes changed, includes put in their place."""

from __future__ import annotations

import re
import xml.parsers.expat
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from pdoik.errors import LoadError

_DEEPEST = 20  # includes in includes


@dataclass(frozen=True, slots=True, kw_only=True)
class Tag:
    """A start tag by its place in the text."""

    name: str
    attributes: Mapping[str, str]
    begin: int
    end: int  # behind its ">"
    owner: str  # the <body> around it
    inside: tuple[str, ...]  # names of the elements around it


def tags_of(text: str) -> Iterator[Tag]:
    """Start tags in their order."""
    raw = text.encode()
    found: list[Tag] = []
    around: list[tuple[str, str]] = []
    parser = xml.parsers.expat.ParserCreate("utf-8")

    def start(name: str, attributes: dict[str, str]) -> None:
        begin = parser.CurrentByteIndex
        owner = next((n for kind, n in reversed(around) if kind == "body"), "")
        found.append(
            Tag(
                name=name,
                attributes=attributes,
                begin=begin,
                end=_end_of_tag(raw, begin),
                owner=owner,
                inside=tuple(kind for kind, _ in around),
            )
        )
        around.append((name, attributes.get("name", "")))

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda name: around.pop()
    parser.Parse(raw, True)
    yield from found


def _end_of_tag(raw: bytes, begin: int) -> int:
    """The place behind the ">" of a start tag, which values in quotes may contain, too."""
    match = re.compile(rb"<(?:[^>\"']|\"[^\"]*\"|'[^']*')*>").match(raw, begin)
    assert match is not None
    return match.end()


def edited(
    text: str, edits: Mapping[tuple[int, int], Mapping[str, str | None]], inserts: Mapping[int, str]
) -> str:
    """The text with other attributes in some start tags, and elements put in, by places."""
    raw = text.encode()
    pieces: list[tuple[int, int, bytes]] = []
    for (begin, end), changed in edits.items():
        tag = _with_attributes(raw[begin:end].decode(), changed)
        pieces.append((begin, end, tag.encode()))
    pieces += [(at, at, element.encode()) for at, element in inserts.items()]
    for begin, end, piece in sorted(pieces, reverse=True):
        raw = raw[:begin] + piece + raw[end:]
    return raw.decode()


def _with_attributes(tag: str, changed: Mapping[str, str | None]) -> str:
    """A start tag's text with other attributes; None takes one away."""
    for name, value in changed.items():
        pattern = re.compile(rf"(\s){re.escape(name)}\s*=\s*(\"[^\"]*\"|'[^']*')")
        if value is None:
            tag = pattern.sub("", tag, count=1)
        elif pattern.search(tag):
            tag = pattern.sub(rf'\g<1>{name}="{value}"', tag, count=1)
        else:
            end = len(tag) - (2 if tag.endswith("/>") else 1)
            tag = f'{tag[:end].rstrip()} {name}="{value}"{tag[end:]}'
    return tag


def with_includes(text: str, folder: Path) -> str:
    """The text with included files' own text in the place of each <include>, as MuJoCo reads them.

    Args:
        text: of the main file.
        folder: of the main file, which included files are relative to.

    Raises:
        LoadError: an included file is not there, or includes itself.
    """
    for _ in range(_DEEPEST):
        found = [tag for tag in tags_of(text) if tag.name == "include"]
        if not found:
            return text
        raw = text.encode()
        for tag in reversed(found):
            path = folder / tag.attributes.get("file", "")
            if not path.is_file():
                raise LoadError(f"{path}: no such file, which an <include> asks for")
            end = tag.end
            if not raw[tag.begin : tag.end].endswith(b"/>"):
                end = raw.index(b">", raw.index(b"</include", tag.end)) + 1
            raw = raw[: tag.begin] + _content(path.read_bytes()) + raw[end:]
        text = raw.decode()
    raise LoadError(f"{folder}: files that include each other more than {_DEEPEST} times deep")


def _content(raw: bytes) -> bytes:
    """What is inside the root element of a file."""
    root = next(tags_of(raw.decode()))
    if raw[root.begin : root.end].endswith(b"/>"):
        return b""
    return raw[root.end : raw.rindex(b"</")].strip()
