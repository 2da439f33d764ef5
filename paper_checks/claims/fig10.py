"""Fig. 10: nuclei of three and seven sites, prepared in phase."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from paper_checks.claim import Claim, Picture, Ruling
from paper_checks.claims._breathers import EPS, A, B, flow
from paper_checks.ruling import fails, holds, partly
from theory.arrays import FloatArray
from verification.pictures.data_table import Curves, long_table
from verification.pictures.figures import COLOURS, new_panels, picture

C = 0.1
SIZES = (3, 7)
NOISE = 1e-6
END = 800.0
TIMES = np.concatenate([np.arange(0.0, 100.0, 2.0), np.arange(100.0, END + 1.0, 5.0)])
IN_PHASE, STEADY = 0.1, 0.05
"""Phase steps, divided by π, that count as in phase; and changes of a step that count as steady."""


@dataclass(frozen=True, kw_only=True)
class InPhase:
    """Phase steps and amplitudes of nuclei prepared in phase."""

    times: FloatArray
    steps: dict[tuple[int, float], FloatArray]
    """Phase steps divided by π, by size and perturbation, one row per time."""
    shapes: dict[int, FloatArray]
    """Final amplitudes by site, without perturbation."""
    localised: bool
    gap: float
    """Difference between (8) by scipy and the averaged chain, in phase steps over π at εt = 12."""

    @property
    def end_steps(self) -> FloatArray:
        """Magnitudes of the phase steps of three sites at the end, divided by π."""
        found: FloatArray = np.abs(self.steps[3, 0.0][-1])
        return found

    @property
    def locked_from(self) -> float:
        """Slow time from which every phase step is within 0.05 π of ±π/2, with mirror symmetry."""
        away = [np.abs(np.abs(self.steps[n, 0.0]) - 0.5).max(axis=1) > STEADY for n in SIZES]
        return float(self.times[np.any(away, axis=0)].max(initial=0.0))

    @property
    def symmetric_change(self) -> float:
        """Largest change of a phase step in the last quarter, with mirror symmetry."""
        late = self.times > 0.75 * END
        return max(float(np.ptp(self.steps[n, 0.0][late], axis=0).max()) for n in SIZES)

    @property
    def wandering(self) -> float:
        """Largest distance of a perturbed phase step from ±π/2 in the second half, divided by π."""
        late = self.times > 0.5 * END
        return max(float(np.abs(np.abs(self.steps[n, NOISE][late]) - 0.5).max()) for n in SIZES)


@lru_cache(maxsize=1)
def in_phase() -> InPhase:
    """Run in-phase nuclei with and without a perturbation, and follow their phase steps."""
    from theory.chains.vdp import VdpChain
    from verification.runs.envelope_run import run_envelope
    from verification.thresholds.preparation import NucleusPreparation, hold, phase_steps

    chain = VdpChain(a=A, b=B, c=C, eps=EPS)
    steps, shapes = {}, {}
    for size in SIZES:
        for noise in (0.0, NOISE):
            preparation = NucleusPreparation(size, perturbation=noise)
            here = preparation.chain(chain, C)
            phi, before, rows = preparation.start(here), 0.0, []
            outside = preparation.nucleus.outside(here.sites)
            for time in TIMES:
                if time > before:
                    phi = run_envelope(here, phi, time - before).phi
                before = time
                core = phi[~outside]
                rows.append(np.angle(core[1:] / core[:-1]) / np.pi)
            steps[size, noise] = np.array(rows)
            if not noise:
                shapes[size] = np.abs(phi)
    # The same start of size 3 in (8), by scipy; by then the phases have long left zero.
    preparation = NucleusPreparation(3)
    here = preparation.chain(chain, C)
    start = preparation.start(here)
    state = flow(np.concatenate([start.imag, start.real]), C, 12.0 / EPS, 1e-9)
    wave = (state[here.sites :] + 1j * state[: here.sites])[
        ~preparation.nucleus.outside(here.sites)
    ]
    seen = np.angle(wave[1:] / wave[:-1]) / np.pi
    expected = phase_steps(hold(chain, preparation, C, 12.0), preparation)
    return InPhase(
        times=TIMES,
        steps=steps,
        shapes=shapes,
        localised=all(
            not hold(chain, NucleusPreparation(size, perturbation=noise), C, END).escaped
            for size in SIZES
            for noise in (0.0, NOISE)
        ),
        gap=float(np.abs(seen - expected).max()),
    )


def rule_in_phase(e: InPhase) -> Ruling:
    """Rule: the nuclei must remain, be steady from the paper's start, and be in phase."""
    if not e.localised or not e.gap < 0.03 or e.symmetric_change > STEADY:
        return fails("nuclei prepared in phase do not reach a steady localised state.")
    if e.end_steps.max() < IN_PHASE:
        return holds()
    return partly(
        "in the “in-phase” mode of oscillation",
        "they leave the in-phase mode, and the steady state that they reach has phase steps of "
        "±π/2.",
    )


def draw(e: InPhase) -> tuple[Picture, ...]:
    """Draw the shapes of Fig. 10, and below each the phase steps against time."""
    figure, panels = new_panels(2, 2, width="page", height=4.2)
    curves = Curves()
    for k, size in enumerate(SIZES):
        shape = e.shapes[size]
        sites = np.arange(shape.size) - shape.size // 2
        near = np.abs(sites) <= 8
        panels[k].bar(*curves.add(f"shape, size {size}", n=sites[near], amplitude=shape[near]),
                      color=COLOURS["blue"], width=0.7)  # fmt: skip
        panels[k].set(title=f"{'ab'[k]}) nucleus size {size}, $c$ = 0.1", xlabel="site n",
                      ylabel=r"amplitude $|\varphi_n|$", xticks=range(-8, 9, 4))  # fmt: skip
        axes = panels[2 + k]
        for noise, colour, label in (
            (0.0, "blue", "exact mirror symmetry"), (NOISE, "vermilion", "perturbed by 1e-6"),
        ):  # fmt: skip
            rows = e.steps[size, noise]
            for link in range(size - 1):
                name = f"size {size}, perturbation {noise:g}, step {link + 1}"
                steps = curves.add(name, slow_time=e.times, phase_step_over_pi=rows[:, link])
                axes.plot(*steps, ".", ms=1.4, color=COLOURS[colour], label="" if link else label)
        axes.axhline(0.0, color="black", lw=1.0, ls="--", label="in phase")
        axes.set(xlabel="slow time εt", ylabel="phase step / π", ylim=(-1.05, 1.05))
        axes.set_yticks((-1, -0.5, 0, 0.5, 1))
    figure.legend(*panels[2].get_legend_handles_labels(), loc="outside lower center", ncols=3,
                  markerscale=4)  # fmt: skip
    return (picture("fig10-breathers", figure, long_table(curves)),)


CLAIMS = (
    Claim.beside("fig10-in-phase", evidence=in_phase, rule=rule_in_phase, figure=draw, weight=2),
)
