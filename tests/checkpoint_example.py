"""A run that tests, and the processes they kill, import by name."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from verification.runs.checkpoint import run_to_end


@dataclass
class Logistic:
    """A run that is chaotic, so that no wrong bit goes unnoticed."""

    steps: int = 3
    pause: float = 0.0
    state: npt.NDArray[np.float64] = field(default_factory=lambda: np.linspace(0.1, 0.9, 7))
    chain: str = "a chain"
    clock: npt.NDArray[np.float64] = field(default_factory=lambda: np.zeros(1))

    @property
    def state_arrays(self) -> dict[str, npt.NDArray[Any]]:
        return {"state": self.state, "clock": self.clock}

    @property
    def metadata(self) -> dict[str, object]:
        return {"steps": self.steps}

    @property
    def time(self) -> float:
        return float(self.clock[0])

    @property
    def finished(self) -> bool:
        return bool(self.clock[0] == self.steps)

    def advance(self, budget: int) -> None:
        if self.pause:
            time.sleep(self.pause)
        self.state *= 3.9 * (1.0 - self.state)
        self.clock += 1

    def check_pace(self) -> None:
        """Accept every pace."""

    def check_state(self) -> None:
        if not np.all(np.isfinite(self.state)):
            raise ValueError("a state that is finite")


def main(path: str) -> None:
    """Run, saying each step, until a signal comes."""

    def shown(fraction: float) -> None:
        if round(fraction * 2000) == 5:
            print(5, flush=True)

    run_to_end([Logistic(2000, 0.01)], 2000.0, 1, Path(path), shown)
