"""The relaxation towards the steady state."""

from functools import lru_cache

import numpy as np

from example_claims._made import Made, made, pictures
from example_claims._trouble import visit
from paper_checks.claim import Verdict
from verification.pictures.figures import new_axes, picture


@lru_cache(maxsize=1)
def _times():
    return np.linspace(0.0, 8.0, 60)


@lru_cache(maxsize=1)
def _drawn():
    time = _times()
    figure, axes = new_axes(xlabel=r"time $t$ (dimensionless)", ylabel=r"amplitude $|u|$")
    axes.semilogy(time, np.exp(-0.7 * time), label="closed form")
    axes.semilogy(time[::6], np.exp(-0.7 * time[::6]), "o", label="direct integration")
    axes.legend()
    return picture(
        "fig9-decay",
        figure,
        {"t": time, "amplitude": np.exp(-0.7 * time)},
        caption='The amplitude falls along a straight line on a logarithmic axis; rate "0.7".',
    )


def _decay():
    visit("fig9-decay")
    return Made(
        verdict=Verdict.REPRODUCED,
        value="0.700 000 000 1",
        error="3e-10, the spread of the two methods",
        tolerance="1e-6: the paper prints three digits",
        explanation="The decay is exponential over four decades.",
        pictures=pictures(_drawn),
    )


def _monotone():
    visit("fig9-monotone")
    return Made(
        verdict=Verdict.PARTIAL,
        value="monotone for t > 1.31",
        error="0.01 in t",
        tolerance="one exception would have changed the verdict",
        explanation="Before t = 1.31 the amplitude rises: it is 2 % above its start.",
        because="it rises at first.",
        part="at all times",
    )


CLAIMS = (
    made(
        "fig9-decay",
        "Fig. 9",
        "The amplitude decays at the rate 0.7.",
        printed="0.7",
        recorded=Verdict.REPRODUCED,
        command="fronts check fig9-decay",
        evidence=_decay,
        shared=_times,
        methods=("least squares on the closed form", "direct integration, order 8"),
    ),
    made(
        "fig9-monotone",
        "Fig. 9, Section 3",
        "The amplitude decreases at all times.",
        printed=None,
        recorded=Verdict.PARTIAL,
        command="fronts check fig9-monotone",
        evidence=_monotone,
        shared=_times,
        methods=("sign of the derivative", "event search in the direct integration"),
    ),
)
