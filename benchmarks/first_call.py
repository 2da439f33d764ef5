"""Time of the first call of a method, in a new process and without compiled code.

numba stores compiled code on disk; each method gets an empty folder for it (NUMBA_CACHE_DIR), so
that the first process compiles and a second one loads. Other programs that compile (jitcode,
heyoka) do so in every process. Times are wall-clock seconds, because compilers run in processes of
their own.
"""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from benchmarks.record import FirstCall

if TYPE_CHECKING:
    from benchmarks.work_precision import Report, WorkPrecision

ROOT = Path(__file__).resolve().parents[1]
LIMIT = 240.0
"""Time limit of one process, in seconds."""


def first_calls(benchmark: WorkPrecision, report: Report) -> tuple[FirstCall, ...]:
    """Return the first calls of the default and of each other program, or why one failed."""
    done = []
    for method in benchmark.first:
        report(f"{benchmark.name}: first call of {method}")
        done.append(first_call(benchmark.module, method))
    return tuple(done)


def first_call(module: str, method: str, limit: float = LIMIT) -> FirstCall:
    """Return the times of one method in two fresh processes, the first with an empty cache."""
    with tempfile.TemporaryDirectory() as cache:
        try:
            cold = _in_a_process(module, method, cache, limit, 1)
            loaded = _in_a_process(module, method, cache, limit, 2)
        except subprocess.TimeoutExpired:
            return FirstCall(method, None, None, None, f"not done within {limit:g} s")
        except ArithmeticError as error:
            return FirstCall(method, None, None, None, str(error)[:160])
    return FirstCall(method, cold[0], loaded[0], loaded[1])


def _in_a_process(module: str, method: str, cache: str, limit: float, calls: int) -> list[float]:
    paths = [str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.first_call", module, method, str(calls)],
        capture_output=True, text=True, timeout=limit, check=False, cwd=cache,
        env={**os.environ, "NUMBA_CACHE_DIR": cache, "PYTHONPATH": os.pathsep.join(paths)},
    )  # fmt: skip
    if done.returncode:
        raise ArithmeticError((done.stderr.strip().splitlines() or ["no message"])[-1])
    found: list[float] = json.loads(done.stdout.strip().splitlines()[-1])
    return found


def _times(module: str, method: str, calls: int) -> list[float]:
    """Return the times of successive calls in one process, without the benchmark's own imports."""
    call = importlib.import_module(module).BENCHMARK.first[method]
    times = []
    for _ in range(calls):
        begin = perf_counter()
        call()
        times.append(perf_counter() - begin)
    return times


if __name__ == "__main__":
    print(json.dumps(_times(sys.argv[1], sys.argv[2], int(sys.argv[3]))))
