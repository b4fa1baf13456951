"""Experiment folders for files that are there already."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from . import _bekker

__all__ = ["Imported", "import_experiment"]


@dataclass(frozen=True)
class Imported:
    """What :func:`import_experiment` made."""

    folder: Path
    kind: Literal["single_wheel", "traverse", "plate_sinkage", "shear"]
    unsure: tuple[str, ...]
    """What is a guess: to be checked."""
    missing: tuple[str, ...]
    """What the files do not say: to be filled in."""
    doubts: tuple[str, ...]
    """What is unlikely, as of an :class:`Experiment`."""
    problem: str | None
    """What keeps the folder from being read until it is filled in; None where it is an experiment."""


def import_experiment(
    files: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    folder: str | os.PathLike[str],
    kind: Literal["single_wheel", "traverse", "plate_sinkage", "shear"] | None = None,
) -> Imported:
    """Proposes an experiment folder for CSV files: which column is which signal, in which unit, as ``bekker import`` does.

    The folder gets copies of the files and an ``experiment.toml`` whose comments say what is a guess.

    Raises:
        InputError: a file cannot be read, or its columns do not tell the kind.
        FileExistsError: the folder is there already.
        OSError: a file cannot be written.
    """
    several = [files] if isinstance(files, (str, os.PathLike)) else files
    root = Path(folder)
    found, unsure, missing, doubts, problem = _bekker.import_experiment(
        [os.fspath(file) for file in several], os.fspath(root), kind
    )
    return Imported(root, found, tuple(unsure), tuple(missing), tuple(doubts), problem)
