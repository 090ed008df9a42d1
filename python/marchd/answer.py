"""Reads JSON into the data classes of answers.py. Members that a class does not know are left out."""

from __future__ import annotations

import dataclasses
import types
import typing
from collections.abc import Mapping
from typing import Any, TypeVar

T = TypeVar("T", bound="Answer")


class Answer:
    """What all answers are."""

    @classmethod
    def from_json(cls: type[T], value: object) -> T:
        """From what the daemon sent. A member that is missing is a TypeError."""
        if not isinstance(value, Mapping):
            raise TypeError(f"{cls.__name__}: expected an object, got {value!r:.100}")
        return cls(**{name: read(kind, value[name]) for name, kind in _fields(cls).items() if name in value})

    def to_json(self) -> dict[str, Any]:
        """As the daemon sent it; members that were absent are null."""
        return dataclasses.asdict(self)


_known_fields: dict[type[Any], dict[str, Any]] = {}


def _fields(cls: type[Any]) -> dict[str, Any]:
    if cls not in _known_fields:
        _known_fields[cls] = typing.get_type_hints(cls)
    return _known_fields[cls]


def read(kind: Any, value: Any) -> Any:
    """The value as that type: data classes are made, also in lists; everything else stays what JSON made it."""
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    if isinstance(kind, type) and issubclass(kind, Answer):
        return kind.from_json(value)
    if origin is list and isinstance(value, list):
        return [read(parts[0], element) for element in value]
    if origin in (types.UnionType, typing.Union) and value is not None:
        return read(next(part for part in parts if part is not types.NoneType), value)
    return value
