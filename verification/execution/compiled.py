"""numba's ``njit``, with compiled code kept on disk until any source of this package changes.

numba by itself looks only at the file in which a compiled function stands: after a change in a
function that it calls from another file, the old code would go on being used, in silence.
"""

from __future__ import annotations

import hashlib
import logging
import os
import shutil
import time
from pathlib import Path

from numba import njit
from numba.core import config

__all__ = ["njit"]

logger = logging.getLogger(__name__)

_HOME = Path(__file__).parents[1]
_PREFIX, _OPTION = "compiled-", "CACHE_DIR"
_WEEK = 7 * 86400.0


def source_digest(folder: Path = _HOME) -> str:
    """Digest of the Python files in a folder and below that have compiled functions.

    Examples
    --------
    >>> source_digest() == source_digest()
    True
    """
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        content = path.read_bytes()
        if b"njit" in content:
            digest.update(path.relative_to(folder).as_posix().encode() + b"\0" + content)
    return digest.hexdigest()[:16]


def _keep_compiled_code() -> None:
    """Name a folder for this state of the sources; remove those of older states, unused a week."""
    given = getattr(config, _OPTION)
    base = Path(given) if given else _HOME / "__pycache__"
    if not given and not os.access(_HOME, os.W_OK):
        base = Path.home() / ".cache" / "fronts"
    folder = base / f"{_PREFIX}{source_digest(_HOME)}"
    if not folder.exists():
        logger.info("compiling the steppers: ten seconds or more, once")
        for old in base.glob(f"{_PREFIX}*"):
            if old.stat().st_mtime < time.time() - _WEEK:
                shutil.rmtree(old, ignore_errors=True)
    setattr(config, _OPTION, str(folder))


_keep_compiled_code()
