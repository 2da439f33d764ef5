"""Fig. 3: a localised and a spreading state of the friction chain."""

from __future__ import annotations

import numpy as np

from paper_checks.claim import Claim, Finding, Verdict
from paper_checks.claims._friction import SITES, chain_of, disagreement
from paper_checks.data_table import long_table
from paper_checks.pictures import COLOURS, new_axes, picture

TIMES_A = (200.0, 400.0, 600.0)
TIMES_B = (400.0, 700.0, 1000.0)
LATE = (1000.0, 2000.0, 4000.0)
STYLES = (("-", "blue"), ("--", "vermilion"), (":", "green"))
XLABEL, YLABEL = "oscillator n", r"vibration amplitude $\tilde{Y}_n$"
SEEN = 0.02
"""Part of the largest amplitude that can be seen in the printed figure: about a line width."""


def _breather() -> Finding:
    """Compare the envelopes at the three times with each other and with much later ones."""
    from verification.runs.excite import excite
    from verification.runs.simulate import simulate

    chain, excited = chain_of(0.004), (15, 16, 17)
    run = simulate(chain, excite(chain, excited), LATE[-1], times=(*TIMES_A, *LATE))
    gap = disagreement(chain_of(0.004, 9), (4, 5, 6), 60.0)
    envelope = run.amplitude
    largest = float(envelope.max())
    change = np.ptp(envelope[:3], axis=0)
    worst = int(np.argmax(change))
    later = [float(np.abs(row - envelope[-1]).max()) for row in envelope[:-1]]
    localised = set(np.flatnonzero(~np.isnan(run.arrivals)) + 1) == set(excited)
    superposed = float(change.max()) < SEEN * largest
    figure, axes = new_axes("column", xlabel=XLABEL, ylabel=YLABEL)
    sites = np.arange(1, SITES + 1)
    axes.axvspan(14.5, 17.5, color="0.9", label="excited, as printed")
    for row, time, (line, colour) in zip(envelope, TIMES_A, STYLES, strict=False):
        axes.plot(sites, row, line, color=COLOURS[colour], label=rf"$\tau$ = {time:g}")
    axes.plot(
        sites, envelope[-1], "o", mfc="none", ms=3, color="0.3", label=rf"$\tau$ = {LATE[-1]:g}"
    )
    axes.legend()
    drawn = picture(
        "fig03-breather",
        "Half of last maximum minus last minimum of y, c = 0.004. The paper states which "
        "oscillators it excites (grey) and that its curves at τ = 200, 400, 600 lie on each other; "
        "it gives no amplitudes.",
        figure,
        long_table(
            {
                f"tau = {t:g}": {"tau": t, "n": sites, "amplitude": envelope[k]}
                for k, t in enumerate((*TIMES_A, *LATE))
            }
        ),
    )
    return Finding(
        verdict=Verdict.REPRODUCED if localised and superposed else Verdict.NOT_REPRODUCED,
        value=(
            f"the envelopes at τ = 200, 400, 600 differ by {change.max():.4f} at site {worst + 1}, "
            f"{100 * change.max() / largest:.1f} % of the largest amplitude"
        ),
        error=f"{run.error:.0e}, from a run at a hundred times the tolerance",
        methods=(
            "Taylor steps from event to event",
            f"DOP853 with located events, 9 sites: every arrival the same to {gap:.0e}",
        ),
        tolerance=f"{SEEN:g} of the largest amplitude to be told apart in print: a line width",
        explanation=(
            "Only the three excited sites ever stick, and in print the three curves cannot be "
            "told apart. That is all the paper says; they are not yet stationary: the amplitudes "
            "of the neighbours still beat. "
            f"From the state at τ = {LATE[-1]:g} the envelope differs by "
            + ", ".join(
                f"{gap:.1e} at τ = {time:g}"
                for gap, time in zip(later, (*TIMES_A, *LATE), strict=False)
            )
            + f". Sliding is damped by 2ξ + μ' = {chain.cell.effective_damping:.4f} only, so that "
            f"the beats decay as exp(-{0.5 * chain.cell.effective_damping:.4f} τ)."
        ),
        pictures=(drawn,),
    )


def _front() -> Finding:
    """Count the sites that stick-slip at the three times."""
    from verification.runs.excite import excite
    from verification.runs.simulate import simulate

    chain = chain_of(0.02)
    run = simulate(chain, excite(chain, [1]), TIMES_B[-1], times=TIMES_B)
    gap = disagreement(chain_of(0.02, 8), (1,), 180.0)
    arrived = [int(np.count_nonzero(run.arrivals <= time)) for time in TIMES_B]
    behind = [float(run.amplitude[k, : arrived[k] - 1].min()) for k in range(3)]
    ahead = [float(run.amplitude[k, arrived[k] + 5 :].max()) for k in range(3)]
    moves = arrived[0] < arrived[1] < arrived[2] < SITES and min(behind) > 10.0 * max(ahead)
    figure, axes = new_axes("column", xlabel=XLABEL, ylabel=YLABEL)
    sites = np.arange(1, SITES + 1)
    axes.axvspan(0.5, 1.5, color="0.9", label="excited, as printed")
    for row, time, (line, colour) in zip(run.amplitude, TIMES_B, STYLES, strict=True):
        axes.plot(sites, row, line, color=COLOURS[colour], label=rf"$\tau$ = {time:g}")
    axes.legend()
    drawn = picture(
        "fig03-front",
        "Half of last maximum minus last minimum of y, c = 0.02. The paper states which oscillator "
        "it excites (grey) and the three times; it gives no amplitudes and no places of its front.",
        figure,
        long_table(
            {
                f"tau = {t:g}": {"tau": t, "n": sites, "amplitude": run.amplitude[k]}
                for k, t in enumerate(TIMES_B)
            }
        ),
    )
    return Finding(
        verdict=Verdict.REPRODUCED if moves else Verdict.NOT_REPRODUCED,
        value="sites that have stuck at τ = 400, 700, 1000: " + ", ".join(map(str, arrived)),
        error=f"none: the arrivals are certain to {run.arrival_error:.0e}",
        methods=(
            "Taylor steps from event to event",
            f"DOP853 with located events, 8 sites: every arrival the same to {gap:.0e}",
        ),
        tolerance="the number must grow, and amplitudes behind must be ten times those ahead",
        explanation=(
            f"Behind the front all sites have amplitudes above {min(behind):.2f}, five sites ahead "
            f"of it below {max(ahead):.3f}. The front is half way along the chain at the last time "
            "in the figure."
        ),
        pictures=(drawn,),
    )


CLAIMS = (
    Claim(
        "fig03-breather",
        "Fig. 3a, section 1.2",
        "At c = 0.004 three excited sites stay a breather: the envelopes at τ = 200, 400 and 600 "
        "cannot be told apart.",
        "at c = 0.4 %, N_dof = 31, N_size = 3, τ = 200, 400, 600",
        Verdict.REPRODUCED,
        "fronts simulate friction --n 31 --c 0.004 --excite 15:17 --t-end 600 --json",
        _breather,
    ),
    Claim(
        "fig03-front",
        "Fig. 3b, section 1.2",
        "At c = 0.02 stick-slip spreads from the excited first site along the chain.",
        "c = 2 %, N_dof = 31, N_size = 1, τ = 400, 700, 1000",
        Verdict.REPRODUCED,
        "fronts simulate friction --n 31 --c 0.02 --excite 1 --t-end 1000 --json",
        _front,
    ),
)
