"""The code that numba has compiled and keeps on disk: where, and for how long."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

FOLDER = "CACHE_DIR"
"""numba's setting for the folder; empty for a folder beside the source of a function."""

WEEK = 7 * 86400.0
"""Seconds for which the code of other sources is kept."""


@contextmanager
def kept_where_numba_would() -> Iterator[None]:
    """Let numba use its own folder within the block, whatever folder this process has named."""
    from numba.core import config

    named = getattr(config, FOLDER)
    setattr(config, FOLDER, os.environ.get(f"NUMBA_{FOLDER}", ""))
    try:
        yield
    finally:
        setattr(config, FOLDER, named)


def remove_unused(paths: Iterable[Path]) -> None:
    """Remove those files and folders that have not changed for a week."""
    for path in paths:
        with suppress(OSError):  # another process may be removing it as well
            if path.stat().st_mtime >= time.time() - WEEK:
                continue
            if path.is_dir():
                shutil.rmtree(path)
            else:
                path.unlink()
