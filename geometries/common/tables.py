"""Reads TOML strictly: each value is requested by key and type, and anything unexpected is an error."""

from __future__ import annotations

import math
import re
import tomllib
from difflib import get_close_matches
from pathlib import Path
from typing import Any, cast

from geometries.common.errors import InputError

Vector3 = tuple[float, float, float]

_FORMAT = 1
"""The version of all formats that this program knows."""
# The units that a document's lengths may have, by how many make a metre.
UNITS_PER_METRE = {"m": 1.0, "mm": 1000.0}
# Largest size of a number: beyond it, products of lengths in the integrals overflow.
LARGEST_NUMBER = 1e30
_LINE = re.compile(r"\(at line (\d+), column \d+\)")


def read_text(path: Path) -> str:
    """Returns the text of a file; InputError when it is missing, unreadable or not UTF-8."""
    if not is_file(path):
        raise InputError(str(path), "", "cannot be read: it does not exist or is not a file")
    try:
        # Read as bytes, because TOML defines the line ends itself; a byte order mark at the beginning is ignored.
        return path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise InputError(str(path), "", f"cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(str(path), "", "is not UTF-8 text") from error


def is_file(path: Path) -> bool:
    """Tells whether a path leads to a regular file, not to a folder, a device or a pipe, which might never end. An invalid path, for
    instance a loop of links, leads to none."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def parse(text: str, source: str) -> Table:
    """Returns the root table of a TOML document; InputError with the line when it is not TOML."""
    try:
        values = tomllib.loads(text)
    except RecursionError as error:
        raise InputError(source, "", "cannot be parsed as TOML: brackets are nested too deeply") from error
    # ValueError, besides TOMLDecodeError, for integers of thousands of digits.
    except ValueError as error:
        found = _LINE.search(str(error))
        reason = "is not TOML: " + _LINE.sub("", str(error)).strip()
        raise InputError(source, "", reason, int(found[1]) if found else None) from error
    return Table(values, source)


class Table:
    """One table of a TOML document, read key by key.

    `label` is what stands before a key in an error: empty, a key path such as `object[2].shape`, or `object "target":`
    with the name. Keys that were never asked for are refused by `finish`. Lengths are divided by `units_per_metre`, which tables within
    this one have, too; what is returned is in metres.
    """

    def __init__(
        self, values: dict[str, Any], source: str, label: str = "", units_per_metre: float = 1.0
    ) -> None:
        self._values = values
        self.units_per_metre = units_per_metre
        self._asked: set[str] = set()
        self._known: set[str] = set()
        self.source = source
        self.label = label

    def key(self, name: str) -> str:
        """Returns the key as error messages name it."""
        if not self.label:
            return name
        return f"{self.label} {name}" if self.label.endswith(":") else f"{self.label}.{name}"

    def error(self, name: str, reason: str) -> InputError:
        return InputError(self.source, self.key(name) if name else self.label, reason)

    def has(self, name: str) -> bool:
        self._known.add(name)
        return name in self._values

    def keys(self) -> tuple[str, ...]:
        return tuple(self._values)

    def value(self, name: str) -> Any:
        """Returns the value of a key, whatever its type; InputError when the key is missing."""
        self._asked.add(name)
        self._known.add(name)
        if name not in self._values:
            meant = get_close_matches(name, self._values, n=1)
            raise self.error(name, f"is missing; is it written as {meant[0]!r}?" if meant else "is missing")
        return self._values[name]

    def allow_only(self, known: tuple[str, ...]) -> None:
        """Refuses every other key, with a list of these."""
        for name in self._values:
            if name not in known:
                raise self.error(name, f"unknown key; there are {', '.join(known)}")

    def finish(self) -> None:
        """Refuses every key that was not requested, with a list of those that were looked for."""
        for name in self._values:
            if name not in self._asked:
                raise self.error(name, f"unknown key; there are {', '.join(sorted(self._known))}")

    def known_format(self) -> None:
        """Refuses a document whose format version is not that of this program."""
        version = self.integer("format", _FORMAT, at_least=1, at_most=1_000_000)
        if version != _FORMAT:
            raise self.error("format", f"is {version}, and this program knows {_FORMAT} only")

    def read_units(self) -> None:
        """Reads the unit of the document's lengths, metres if there is none."""
        self.units_per_metre = UNITS_PER_METRE[self.choice("units", tuple(UNITS_PER_METRE))]

    def text(self, name: str, default: str | None = None) -> str:
        if default is not None and not self.has(name):
            return default
        value = self.value(name)
        if not isinstance(value, str):
            raise self.error(name, f"must be a string, not {value!r}")
        if not value:
            raise self.error(name, "must not be empty")
        return value

    def choice(self, name: str, choices: tuple[str, ...]) -> str:
        """Returns a text that is one of the choices, the first of them when the key is missing."""
        if not self.has(name):
            return choices[0]
        value = self.value(name)
        if value not in choices:
            *others, last = (f'"{choice}"' for choice in choices)
            raise self.error(name, f"must be {', '.join(others)} or {last}")
        return str(value)

    def texts(self, name: str) -> tuple[str, ...]:
        """Returns a list of strings, which has at least one and none twice."""
        value = self.value(name)
        if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
            raise self.error(name, "must be a list of strings")
        if not value:
            raise self.error(name, "must not be empty")
        for index, item in enumerate(value):
            if item in value[:index]:
                raise self.error(name, f'"{item}" is named twice')
        return tuple(value)

    def boolean(self, name: str, default: bool) -> bool:
        if not self.has(name):
            return default
        value = self.value(name)
        if not isinstance(value, bool):
            raise self.error(name, f"must be true or false, not {value!r}")
        return value

    def integer(self, name: str, default: int, at_least: int, at_most: int) -> int:
        if not self.has(name):
            return default
        value = self.value(name)
        if not isinstance(value, int) or isinstance(value, bool):
            raise self.error(name, f"must be an integer, not {value!r}")
        if value < at_least:
            raise self.error(name, f"must be at least {at_least}, not {value}")
        if value > at_most:
            raise self.error(name, f"must be at most {at_most}, not {value}")
        return value

    def number(self, name: str, default: float | None = None) -> float:
        if default is not None and not self.has(name):
            return default
        return self.as_number(name, self.value(name))

    def positive(self, name: str, default: float | None = None) -> float:
        value = self.number(name, default)
        if value <= 0:
            raise self.error(name, f"must be greater than 0, not {value!r}")
        return value

    def vector(self, name: str, length: int) -> tuple[float, ...]:
        return self.as_vector(name, self.value(name), length)

    def vector3(self, name: str) -> Vector3:
        return cast(Vector3, self.vector(name, 3))

    def length(self, name: str) -> float:
        """Returns a length in metres."""
        return self.number(name) / self.units_per_metre

    def positive_length(self, name: str) -> float:
        """Returns a length > 0 in metres."""
        value = self.length(name)
        if value <= 0:
            raise self.error(name, f"must be greater than 0, not {value!r}")
        return value

    def lengths(self, name: str, length: int) -> tuple[float, ...]:
        """Returns a list of lengths in metres."""
        return self.as_lengths(name, self.value(name), length)

    def position(self, name: str, default: Vector3 | None = None) -> Vector3:
        """Returns a point or a translation in metres; the default is in metres, too."""
        if default is not None and not self.has(name):
            return default
        return cast(Vector3, self.lengths(name, 3))

    def as_number(self, name: str, value: Any) -> float:
        """Returns `value`, found at `name`, as a finite number."""
        if not isinstance(value, (int, float)) or isinstance(value, bool):
            raise self.error(name, f"must be a number, not {value!r}")
        if isinstance(value, int) and not -(2**63) <= value < 2**63:
            raise self.error(name, "is an integer of more than 64 bits")
        number = float(value)
        if not math.isfinite(number):
            raise self.error(name, f"must be finite, not {value!r}")
        if abs(number) > LARGEST_NUMBER:
            raise self.error(name, f"must be at most {LARGEST_NUMBER:g}, not {value!r}")
        return number + 0.0  # The sum turns -0.0 into 0.0.

    def as_vector(self, name: str, value: Any, length: int) -> tuple[float, ...]:
        """Returns `value`, found at `name`, as a list of `length` finite numbers."""
        if not isinstance(value, list) or len(value) != length:
            raise self.error(name, f"must be a list of {length} numbers, not {value!r}")
        return tuple(self.as_number(f"{name}[{index}]", item) for index, item in enumerate(value))

    def as_lengths(self, name: str, value: Any, length: int) -> tuple[float, ...]:
        """Returns `value`, found at `name`, as a list of `length` lengths in metres."""
        return tuple(number / self.units_per_metre for number in self.as_vector(name, value, length))

    def table(self, name: str, required: bool = True) -> Table:
        """Returns a table within this one; an empty one when it is absent and not required."""
        if not required and not self.has(name):
            return Table({}, self.source, self.key(name), self.units_per_metre)
        value = self.value(name)
        if not isinstance(value, dict):
            raise self.error(name, f"must be a table, not {value!r}")
        return Table(value, self.source, self.key(name), self.units_per_metre)

    def tables(self, name: str) -> list[Table]:
        """Returns a list of tables within this one; none when it is absent. Tables with a name are labelled by it."""
        if not self.has(name):
            return []
        value = self.value(name)
        if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
            raise self.error(name, "must be a list of tables")
        return [
            Table(item, self.source, self._label(name, index, item), self.units_per_metre)
            for index, item in enumerate(value)
        ]

    def _label(self, name: str, index: int, item: dict[str, Any]) -> str:
        given = item.get("name")
        if not self.label and isinstance(given, str) and given:
            return f'{name} "{given}":'
        return self.key(f"{name}[{index}]")
