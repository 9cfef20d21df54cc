"""Writes what follows from the options' declarations in cpp/include/pdoik; --check only compares.

An option is a member of a struct below: its name, type, default and comment. The comment ends with
the range of a number, `in [0, inf)`, whose ends may be other options of the struct, and its unit.
From them come cpp/include/pdoik/option_fields.hpp, whose table the range checks and the bindings
walk, and the dataclasses of python/pdoik/options.py.
"""

from __future__ import annotations

import re
import subprocess
import sys
import sysconfig
import textwrap
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HEADERS = ROOT / "cpp" / "include" / "pdoik"
SOURCES = (  # each with what its structs need before it
    *("goal.hpp", "lbfgs.hpp", "augmented_lagrangian.hpp", "levenberg_marquardt.hpp"),
    "options.hpp",
)
WRITTEN = "Written by python/bindings/option_fields.py from the options' headers: edit those."
PYTHON_NAMES = {"TouchOptions": "Touch", "BalanceOptions": "Balance"}
ARRAY = "NDArray[np.float64]"

# Of a type in C++: the annotation in Python, the default ({} is the core's), and what Python adds.
TYPES = {
    "bool": ("bool", "{}", ""),
    "int": ("int", "{}", ""),
    "std::uint64_t": ("int", "{}", ""),
    "double": ("float", "{}", ""),
    "std::optional<bool>": ("bool | None", "{}", ""),
    "std::vector<std::string>": ("Sequence[str]", "tuple({})", ""),
    "Eigen::VectorXd": (f"Sequence[float] | {ARRAY}", "tuples({})", ""),
    "Eigen::Vector3d": ("Vector3", "tuples({})", "Shape (3,)."),
    "Eigen::Isometry3d": (f"Sequence[Sequence[float]] | {ARRAY}", "tuples({})", "Shape (4, 4)."),
    "std::vector<Contact>": (
        f"Mapping[str, Sequence[Vector3] | {ARRAY}]",
        "field(default_factory=dict, hash=False)",
        "By link name, shape (K, 3) in the link frame [m].",
    ),
}
AXIS = ("Axis | Vector3", '"z"', 'A letter, "x", "y" or "z", or shape (3,).')  # of goal_axis
RAISES = """\
    Raises:
        TypeError: A name is unknown, or a value is of the wrong type.
        ValueError: A shape is wrong, or a str is not one of its choices. Numbers out of range come
            out when a solver is made."""
NESTED_RAISES = """\
    Raises:
        ValueError: A shape is wrong. Numbers and links come out when a solver is made, and choices
            when they become part of Options."""
RENAMED = "heed_fixed_hulls: InitVar[bool | None] = None  # what base_collision was called once"

COMMENT = r"((?:^ *///(?!<)[^\n]*\n)*)"
TRAILING = r"((?: *///<[^\n]*\n)*)"
MEMBER = re.compile(
    COMMENT + r"^  ([\w:]+(?:<[\w:]+>)?) (\w+)(?:\s*=\s*([^;]*)|\{[^;]*\})?; *\n?" + TRAILING, re.M
)
UNREAD = re.compile(r"^  (?!using|struct|static)[\w:][\w:<>, ]* (\w+)(?: =|=|\{|;)", re.M)
ENUMERATOR = re.compile(COMMENT + r"^  (\w+),\n?" + TRAILING, re.M)
RANGE = re.compile(r"\b[iI]n ([\[(])([^][(), ]+), ([^][(), ]+)([\])])(?: (\[[^]]+\]))?\.?$")


def snake(name: str) -> str:
    """`LookAt` as `look_at`."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def text_of(comment: str) -> str:
    """The first paragraph of a comment, without groups' marks."""
    lines = [re.sub(r"^ *///<? ?", "", line) for line in comment.splitlines()]
    paragraph = "\n".join(line for line in lines if not line.startswith("@")).split("\n\n")[0]
    return " ".join(paragraph.split())


@dataclass(frozen=True)
class Range:
    """Which numbers an option may be."""

    opening: str
    low: str
    high: str
    closing: str
    unit: str
    whole: bool

    @classmethod
    def of(cls, where: str, type_: str, text: str) -> Range | None:
        """The range at a comment's end; None for what is no number, or any whole number."""
        if type_ not in ("double", "int"):
            return None
        found = RANGE.search(text)
        if found is None:
            raise SystemExit(f"{where}: its comment ends with no range such as 'in [0, inf) [m]'")
        return cls(*found.groups(default=""), type_ == "int")

    def holds(self, name: str) -> str:
        """A condition in C++, false of NaN."""
        tests = []
        if self.low != "-inf":
            tests.append(f"o.{name} >{'=' * (self.opening == '[')} {self.number(self.low)}")
        if self.high != "inf":
            tests.append(f"o.{name} <{'=' * (self.closing == ']')} {self.number(self.high)}")
        elif self.closing == ")" and not self.whole:
            tests.append(f"std::isfinite(o.{name})")
        return " && ".join(tests)

    def number(self, end: str) -> str:
        """An end in C++: a literal, or another option of the struct."""
        try:
            return repr(int(float(end)) if self.whole else float(end))
        except ValueError:
            return f"o.{end}"

    def words(self) -> str:
        """What an error says was expected."""
        ends, finite = self.opening + self.closing, "" if self.whole else "finite "
        bounds = (self.low, self.high)
        if bounds == ("-inf", "inf"):
            words = f"a {finite}number"
        elif bounds == ("0", "inf") and ends[0] == "(":
            words = f"a positive {finite if ends[1] == ')' else ''}number"
        elif self.high == "inf":
            least = f"{'at least' if ends[0] == '[' else 'above'} {self.low}"
            of = "of " * (ends[0] == "[")
            words = least if self.whole or ends[1] == "]" else f"a finite number {of}{least}"
        elif ends == "[]":
            words = f"{self.low} to {self.high}"
        else:
            words = f"a number in {ends[0]}{self.low}, {self.high}{ends[1]}"
        return f"{words} {self.unit}".rstrip()


@dataclass(frozen=True)
class Option:
    """A member of a struct."""

    name: str
    type: str
    default: str
    text: str
    range: Range | None


@dataclass(frozen=True)
class Struct:
    """The options of one thing."""

    name: str
    text: str
    options: list[Option]

    @property
    def python(self) -> str:
        """Its name in Python."""
        return PYTHON_NAMES.get(self.name, self.name)


@dataclass(frozen=True)
class Declared:
    """All that the headers declare."""

    structs: list[Struct]
    enums: dict[str, dict[str, str]]  # enumerators with their comments

    def place(self, struct: Struct) -> str:
        """By which name the solver's options have it."""
        names = [o.name for o in self.structs[-1].options if o.type == struct.name]
        return names[0] if names else ""

    def choices(self, option: Option) -> dict[str, str]:
        """The enumerators that its comment names, or else all, with their comments."""
        values = self.enums.get(option.type, {})
        named = {
            name: says for name, says in values.items() if f"{option.type}::{name}" in option.text
        }
        return named or values

    def name_of_enum(self, enum: str) -> str:
        """The option that it is the type of, else its own name."""
        names = (o.name for each in self.structs for o in each.options if o.type == enum)
        return next(names, snake(enum))


def read() -> Declared:
    """The structs of options, the solver's last, and the enums that are options' types."""
    text = "".join((HEADERS / name).read_text() for name in SOURCES)
    structs = []
    for comment, name, body in re.findall(
        COMMENT + r"^struct (\w*Options) \{\n(.*?)^\};", text, re.M | re.S
    ):
        options = []
        for before, type_, member, default, after in MEMBER.findall(body):
            says = text_of(before or after)
            about = Range.of(f"{name}::{member}", type_, says)
            options.append(Option(member, type_, default, says, about))
            if type_.startswith(("std::", "Eigen::")) and type_ not in TYPES:
                raise SystemExit(f"{name}::{member}: TYPES has no {type_}")
        if unread := UNREAD.search(MEMBER.sub("", body)):
            raise SystemExit(f"{name}::{unread[1]}: its type is not understood")
        structs.append(Struct(name, text_of(comment), options))
    used = {o.type for each in structs for o in each.options}
    enums = {}
    for name, body in re.findall(r"^enum class (\w+) \{\n(.*?)^\};", text, re.M | re.S):
        if name in used:
            found = ENUMERATOR.findall(body)
            enums[name] = {each: text_of(before or after) for before, each, after in found}
    return Declared(structs, enums)


def to_cpp(declared: Declared) -> str:
    """option_fields.hpp."""
    parts = [
        f"// {WRITTEN}\n#pragma once\n#include <array>\n#include <cmath>\n#include <tuple>\n"
        '#include <type_traits>\n#include <utility>\n#include "pdoik/options.hpp"\n'
        "\nnamespace pdoik::detail {\n\n"
        "/// A member of a struct of options.\n"
        "template <class Struct, class Value> struct Field {\n"
        "const char* name;  ///< as it is declared\n"
        "Value Struct::*member;  ///< where it is\n"
        "bool (*holds)(const Struct&);  ///< whether it is in its range; null for any value\n"
        "const char* expected;  ///< the range in words\n};\n\n"
        "template <class Struct, class Value>\n"
        "Field(const char*, Value Struct::*, std::type_identity_t<bool (*)(const Struct&)>,"
        " const char*) -> Field<Struct, Value>;\n\n"
        "/// All members of a struct of options, in order.\n"
        "template <class Struct> inline constexpr std::tuple<> option_fields{};\n"
        "/// The words for the enumerators of an enum.\n"
        "template <class Enum>\n"
        "inline constexpr std::array<std::pair<Enum, const char*>, 0> enumerator_names{};\n\n"
    ]
    for enum, values in declared.enums.items():
        pairs = ",".join(f'std::pair{{{enum}::{each}, "{snake(each)}"}}' for each in values)
        parts.append(
            f"template <> inline constexpr std::array enumerator_names<{enum}>{{{pairs}}};\n"
        )
    for struct in declared.structs:
        rows = []
        for o in struct.options:
            holds, words = "nullptr", ""
            if o.range is not None:
                holds = f"[](const {struct.name}& o) {{ return {o.range.holds(o.name)}; }}"
                words = o.range.words()
            rows.append(f'Field{{"{o.name}", &{struct.name}::{o.name}, {holds}, "{words}"}}')
        table = ",\n".join(rows)
        parts.append(
            f"\ntemplate <> inline constexpr std::tuple option_fields<{struct.name}>{{{table}}};\n"
        )
    return "".join(parts) + "\n}\n"


def to_python(declared: Declared) -> str:
    """options.py."""
    parts = [
        '"""The options of a solver, with their defaults, ranges and units.\n\n'
        f'{WRITTEN}\n"""\n# ruff: noqa: RUF009  (defaults are those of C++, read once)\n\n'
        "from collections.abc import Mapping, Sequence\n"
        "from dataclasses import InitVar, dataclass, field\n"
        "from typing import ClassVar, Literal\n\n"
        "import numpy as np\nfrom numpy.typing import NDArray\n\n"
        "from pdoik._option_values import DEFAULT, Axis, NestedOptions, SolverOptions, Vector3,"
        " tuples\n\n"
    ]
    for struct in declared.structs:
        place = declared.place(struct)
        base = "NestedOptions" if place else "SolverOptions"
        about = "".join(wrapped(f"{o.name}: {python_text(o, declared)}") for o in struct.options)
        parts.append(
            f"@dataclass(frozen=True, slots=True, kw_only=True)\nclass {struct.python}({base}):\n"
            f'    """{struct.text}\n\n    Attributes:\n{about}\n'
            f'{NESTED_RAISES if place else RAISES}\n    """\n\n'
        )
        if place:
            parts.append(f'    place: ClassVar[str] = "{place}"\n')
        parts += [f"    {python_field(o, place, declared)}\n" for o in struct.options]
        if not place:
            parts.append(f"\n    {RENAMED}\n")
        parts.append("\n\n")
    return "".join(parts)


def wrapped(text: str) -> str:
    """An entry of a docstring's list, in lines that do not part the ends of a range."""
    whole = RANGE.sub(lambda found: found[0].replace(", ", ",\0"), text)
    lines = textwrap.fill(
        whole, 100, initial_indent=" " * 8, subsequent_indent=" " * 12, break_on_hyphens=False
    )
    return lines.replace("\0", " ") + "\n"


def python_type(option: Option, declared: Declared) -> tuple[str, str, str]:
    """Annotation, default and what is to be added to the comment, as in `TYPES`."""
    if option.name == "goal_axis":
        return AXIS
    if option.type in declared.enums:
        choices = ", ".join(f'"{snake(each)}"' for each in declared.choices(option))
        return f"Literal[{choices}]", f'"{snake(option.default.split("::")[-1])}"', ""
    for struct in declared.structs:
        if option.type == struct.name:
            return struct.python, f"{struct.python}()", ""
    return TYPES[option.type]


def python_field(option: Option, place: str, declared: Declared) -> str:
    """Its line in the dataclass."""
    annotation, default, _ = python_type(option, declared)
    core = ".".join(filter(None, ("DEFAULT", place, option.name)))
    return f"{option.name}: {annotation} = {default.format(core)}"


def python_text(option: Option, declared: Declared) -> str:
    """Its comment in the words of Python, with the choices that it has."""
    text = option.text.rstrip(".")
    choices = declared.choices(option)
    if choices and f"{option.type}::" not in text:
        text += ": " + "; ".join(f'"{snake(each)}", {says}' for each, says in choices.items())
        text = text.rstrip(".")

    def as_word(found: re.Match[str]) -> str:
        enum, each = found.groups()
        word = f'"{snake(each)}"'
        return word if enum == option.type else f"{declared.name_of_enum(enum)} {word}"

    text = re.sub(r"\b(\w+)::([A-Z]\w*)", as_word, text).replace("std::nullopt", "None")
    text = text.replace("::", ".")
    if re.match(r"[a-z]+ ", text):
        text = text[0].upper() + text[1:]
    return f"{text}. {python_type(option, declared)[2]}".rstrip()


def formatted(text: str, *command: str) -> str:
    """A formatter's output: those of the interpreter's environment."""
    tool = Path(sysconfig.get_path("scripts")) / command[0]
    done = subprocess.run(
        [str(tool), *command[1:]], input=text, capture_output=True, text=True, check=True, cwd=ROOT
    )
    return done.stdout


def main() -> None:
    """Write both files, or say which of them differs."""
    declared = read()
    header, module = HEADERS / "option_fields.hpp", ROOT / "python" / "pdoik" / "options.py"
    wanted = {
        header: formatted(to_cpp(declared), "clang-format", f"--assume-filename={header}"),
        module: formatted(to_python(declared), "ruff", "format", "--stdin-filename", str(module)),
    }
    if sys.argv[1:] != ["--check"]:
        for path, text in wanted.items():
            path.write_text(text)
        return
    for path, text in wanted.items():
        if not path.exists() or path.read_text() != text:
            name = path.relative_to(ROOT)
            sys.exit(f"{name} is not what the headers say: python python/bindings/option_fields.py")


if __name__ == "__main__":
    main()
