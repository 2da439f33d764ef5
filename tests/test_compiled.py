"""Compiled code on disk belongs to the sources as they are now."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

SCRIPT = """
import sys
sys.path.insert(0, {folder!r})
import verification.execution.compiled as compiled
from numba.core import config
compiled._HOME = __import__("pathlib").Path({folder!r})
config.CACHE_DIR = {cache!r}
compiled._keep_compiled_code()
from outer import outer
print(outer(1.0))
"""


def _answer(folder: Path, cache: Path) -> float:
    script = SCRIPT.format(folder=str(folder), cache=str(cache))
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=120
    )
    return float(done.stdout)


def test_a_change_in_a_called_file_is_seen(tmp_path: Path) -> None:
    """The outer function's own file stays as it is; numba alone would give the old answer."""
    folder, cache = tmp_path / "code", tmp_path / "cache"
    folder.mkdir()
    inner = "from numba import njit\n@njit(cache=True)\ndef inner(x):\n    return {} * x\n"
    outer = (
        "from numba import njit\nfrom inner import inner\n"
        "@njit(cache=True)\ndef outer(x):\n    return inner(x)\n"
    )
    (folder / "inner.py").write_text(inner.format("2.0"))
    (folder / "outer.py").write_text(outer)
    assert _answer(folder, cache) == 2.0
    assert _answer(folder, cache) == 2.0
    (folder / "inner.py").write_text(inner.format("3.25"))
    assert _answer(folder, cache) == 3.25
    assert len(list(cache.glob("compiled-*"))) == 2
