"""Functions that test_pool.py, and the processes it kills, import by name."""

from __future__ import annotations

import os
import time

from verification.execution.pool import answers


def inverse(item: int) -> float:
    return 1.0 / item


def deadly(item: int) -> int:
    if item == 3:
        os._exit(9)
    time.sleep(0.1)
    return item * item


def endless(item: int) -> int:
    """Hold the interpreter for half a minute, as compiled code does: no other thread gets on."""
    os.write(1, f"{os.getpid()}\n".encode())
    return int(pow(7, 10**item) % 10)


def main() -> None:
    for _ in answers(endless, [8, 8], workers=2):
        pass
