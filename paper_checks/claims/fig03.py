"""Fig. 3: a breather and a front of the friction chain."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._friction import SITES, chain_of, disagreement
from paper_checks.claims._required import required
from paper_checks.ruling import fails, holds, partly
from theory.arrays import FloatArray
from verification.pictures.data_table import Curves, long_table
from verification.pictures.figures import COLOURS, new_axes, picture

TIMES_A, TIMES_B = (200.0, 400.0, 600.0), (400.0, 700.0, 1000.0)
CORE = (15, 16, 17)
LINE = 0.02
"""Thickness of a drawn curve relative to the height of its axis: 1.2 points of about 60."""
VANISHING = 0.05
"""Largest fraction of the core's amplitude that can be read as zero in the figure."""
AGREE = 1e-3
STYLES = (("o-", "blue"), ("s--", "vermilion"), ("^:", "green"))


@dataclass(frozen=True, kw_only=True)
class BreatherEnvelopes:
    """Envelopes of the chain of Fig. 3a at its three times, shape (3, 31)."""

    envelope: FloatArray
    stuck: tuple[int, ...]
    """Sites that have stuck by the last time."""
    gap: float

    @property
    def apart(self) -> float:
        """Largest difference between the three envelopes, relative to the largest amplitude."""
        return float(np.ptp(self.envelope, axis=0).max() / self.envelope.max())

    @property
    def where(self) -> int:
        """The site of the largest difference."""
        return int(np.ptp(self.envelope, axis=0).argmax()) + 1

    @property
    def own(self) -> float:
        """The same difference relative to the amplitude of its own site."""
        n = self.where - 1
        return float(np.ptp(self.envelope[:, n]) / self.envelope[-1, n])

    @property
    def core(self) -> float:
        """Largest amplitude."""
        return float(self.envelope[-1].max())

    @property
    def beside(self) -> tuple[float, float, float]:
        """Amplitudes one, two and three sites outside the core, at the last time."""
        last = self.envelope[-1]
        return tuple(float(last[CORE[-1] + k]) for k in range(3))  # type: ignore[return-value]


@lru_cache(maxsize=1)
def breather() -> BreatherEnvelopes:
    """Run the chain of Fig. 3a; compare its first sticks with scipy on a short chain."""
    from verification.runs.excite import excite
    from verification.runs.simulate import simulate

    chain = chain_of(0.004)
    run = simulate(chain, excite(chain, CORE), TIMES_A[-1], times=TIMES_A)
    return BreatherEnvelopes(
        envelope=run.amplitude,
        stuck=tuple(int(n) + 1 for n in np.flatnonzero(np.isfinite(run.arrivals))),
        gap=disagreement(chain_of(0.004, 7), (3, 4, 5), 60.0),
    )


def rule_superimposed(e: BreatherEnvelopes) -> Ruling:
    """Rule: the three curves must agree within a line's thickness; only the core may stick."""
    if e.stuck == CORE and e.apart < LINE and e.gap < AGREE:
        return holds()
    return fails("the three envelopes can be distinguished, or other sites stick as well.")


def rule_vanishing(e: BreatherEnvelopes) -> Ruling:
    """Rule: outside the core the amplitude must be invisibly small, and no site may stick."""
    if e.stuck != CORE or not e.gap < AGREE:
        return fails("sites outside the nucleus stick.")
    if e.beside[0] < VANISHING * e.core:
        return holds()
    return partly(
        "(with vanishing amplitude)",
        f"the two sites beside the nucleus slide with {e.beside[0] / e.core:.0%} of its amplitude, "
        "and only those beyond have hardly any.",
    )


def draw_breather(e: BreatherEnvelopes) -> tuple[Picture, ...]:
    """Draw Fig. 3a."""
    return _draw("fig03-breather", e, TIMES_A, CORE, "0.4 %")


def _draw(
    name: str,
    e: BreatherEnvelopes | FrontEnvelopes,
    times: tuple[float, ...],
    core: tuple[int, ...],
    c: str,
) -> tuple[Picture, ...]:
    """Draw the envelopes at several times, and mark the excited sites."""
    figure, axes = new_axes(
        "column", xlabel="oscillator n", ylabel=r"vibration amplitude $\tilde{Y}_n$"
    )
    sites, curves = np.arange(1, SITES + 1), Curves()
    axes.axvspan(core[0] - 0.5, core[-1] + 0.5, color="0.9",
                 label="excited: " + ", ".join(map(str, core)))  # fmt: skip
    for row, time, (line, colour) in zip(e.envelope, times, STYLES, strict=True):
        curves[f"tau = {time:g}"] = {"tau": time, "n": sites, "amplitude": row}
        axes.plot(sites, row, line, color=COLOURS[colour], label=rf"$\tau$ = {time:g}")
    axes.set(title=rf"$c$ = {c}, $\tilde{{v}}_d$ = 1.25, $N_\mathrm{{dof}}$ = 31")
    axes.legend()
    return (picture(name, figure, long_table(curves)),)


@dataclass(frozen=True, kw_only=True)
class FrontEnvelopes:
    """The front of Fig. 3b at its three times."""

    envelope: FloatArray
    arrived: tuple[int, ...]
    trailing: tuple[float, ...]
    ahead: tuple[float, ...]
    arrival_error: float
    gap: float


def front() -> FrontEnvelopes:
    """Count the sites in stick-slip at the three times, and compare amplitudes."""
    from verification.runs.excite import excite
    from verification.runs.simulate import simulate

    chain = chain_of(0.02)
    run = simulate(chain, excite(chain, [1]), TIMES_B[-1], times=TIMES_B)
    arrived = [int(np.count_nonzero(run.arrivals <= time)) for time in TIMES_B]
    return FrontEnvelopes(
        envelope=run.amplitude,
        arrived=tuple(arrived),
        trailing=tuple(float(run.amplitude[k, : arrived[k] - 1].min()) for k in range(3)),
        ahead=tuple(float(run.amplitude[k, arrived[k] + 5 :].max()) for k in range(3)),
        arrival_error=required(run.arrival_error, "error of the arrivals"),
        gap=disagreement(chain_of(0.02, 8), (1,), 180.0),
    )


def rule_front(e: FrontEnvelopes) -> Ruling:
    """Rule: more sites each time, and ten times the amplitude behind the front than ahead of it."""
    moves = all(a < b for a, b in zip(e.arrived, (*e.arrived[1:], SITES), strict=True))
    if moves and min(e.trailing) > 10.0 * max(e.ahead) and e.gap < AGREE:
        return holds()
    return fails("stick-slip does not spread from the excited site.")


def draw_front(e: FrontEnvelopes) -> tuple[Picture, ...]:
    """Draw Fig. 3b."""
    return _draw("fig03-front", e, TIMES_B, (1,), "2 %")


CLAIMS = (
    Claim.beside("fig03-breather", evidence=breather, rule=rule_superimposed, figure=draw_breather),
    Claim.beside("fig03-vanishing", evidence=breather, rule=rule_vanishing, weight=0),
    Claim.beside("fig03-front", evidence=front, rule=rule_front, figure=draw_front),
)
