"""Reads job files as `march submit` does: input files get absolute paths, and GLSL is put in as text."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

from .errors import JobError
from .job_format import JobDocument


def load_job(path: str | os.PathLike[str]) -> JobDocument:
    """The document of a job file, to be submitted from anywhere. JobError: it is no JSON, or a file is missing."""
    file = Path(path)
    try:
        document = json.loads(file.read_text(encoding="utf-8-sig"))
    except ValueError as error:
        raise JobError(f"{file}: {error}") from None
    if isinstance(document, dict):
        resolve_files(document, file.parent)
    return cast(JobDocument, document)


def resolve_files(document: dict[str, Any], folder: str | os.PathLike[str]) -> None:
    """Makes paths of input files absolute, starting from the folder, and puts in the text of GLSL files."""
    root = Path(folder).resolve()
    for place, part, is_density in _parts_with_files(document):
        name = part.get("file")
        if not isinstance(name, str) or not name or (is_density and part.get("kind") not in ("grid", "glsl")):
            continue
        path = root / name
        if ".." in path.parts:
            path = Path(os.path.realpath(path.parent)) / path.name
        if part.get("kind") == "glsl" and "source" not in part:
            try:
                part["source"] = path.read_text(encoding="utf-8-sig")
            except (OSError, ValueError) as error:
                raise JobError(f"{place}.file: {error}", place=f"{place}.file") from None
        part["file"] = str(path)


def _member(value: Any, *keys: str) -> Any:
    for key in keys:
        value = value.get(key) if isinstance(value, dict) else None
    return value


def _parts_with_files(document: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any], bool]]:
    """Each object that may name a file: its place, itself, and whether it is a density."""
    for name, ways in (
        ("media", ((("density",), True),)),
        ("objects", ((("material", "texture"), False), (("material", "interior", "density"), True))),
    ):
        members = _member(document, "scene", name)
        for i, member in enumerate(members if isinstance(members, list) else []):
            for keys, is_density in ways:
                part = _member(member, *keys)
                if isinstance(part, dict):
                    yield ".".join([f"scene.{name}[{i}]", *keys]), part, is_density
