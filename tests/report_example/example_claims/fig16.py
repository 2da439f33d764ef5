"""The front."""

from functools import lru_cache

import numpy as np

from example_claims._made import Made, made, pictures
from example_claims._trouble import visit
from paper_checks.claim import Erratum, Fault, Formula, Verdict
from verification.pictures.data_table import long_table
from verification.pictures.figures import new_panels, picture


@lru_cache(maxsize=1)
def _drawn():
    c = np.linspace(0.1, 3.0, 80)
    figure, (left, right) = new_panels(2)
    left.plot(c, np.sqrt(c), label=r"$\sqrt{c}$")
    left.plot(c, 0.5 * c, "--", label="linear, as the paper says")
    left.set(xlabel=r"coupling $c$", ylabel=r"velocity $\hat v$")
    left.legend()
    right.plot(c, 0.5 + 0.1 * np.exp(-c), color="#D55E00")
    right.set(xlabel=r"coupling $c$", ylabel=r"exponent $d\ln \hat v / d\ln c$", ylim=(0, 1))
    return picture(
        "fig16-speed",
        figure,
        long_table(
            {
                "closed form": {"c": c, "v": np.sqrt(c)},
                "simulated": {"c": c[::9], "v": np.sqrt(c[::9])},
                "linear": {"c": c, "v": 0.5 * c},
                "local exponent": {"c": c, "exponent": 0.5 + 0.1 * np.exp(-c)},
            }
        ),
        caption="Left: velocity against coupling. Right: the local exponent tends to 1/2.",
    )


def _speed():
    visit("fig16-speed")
    return Made(
        verdict=Verdict.NOT_REPRODUCED,
        value="exponent 0.500 000 2 at c = 10⁴",
        error="4e-7, from the residual of the relation",
        tolerance="0.02: half of the difference between the two statements",
        explanation=(
            "The velocity grows as the square root of the coupling, not linearly.\n\n"
            "Over the plotted range the curve looks straight because it starts at a fold; "
            "one decade further the exponent is within 1 % of 1/2 & stays there <for good>."
        ),
        because="a fold looks straight over a <short> range; later v_d grows like c^{1/2}.",
        pictures=pictures(_drawn),
    )


def _misprint():
    visit("fig16-misprint")
    return Made(
        verdict=Verdict.CORRECTED,
        value="a² + b²",
        error="none: an identity",
        tolerance="none: the two sides are equal or not",
        explanation="The second term is printed with a minus sign.",
        because="the second term is printed with a minus sign.",
        formulas=(Formula("As printed", r"a^2 - b^2 < \alpha"),),
        erratum=Erratum(
            Fault.MISPRINT,
            "$a^2 - b^2$ <u>",
            r"$\frac{a^3 + a b^2}{a}$",
            "The sign of b² & no other.",
            "Print fails at <random> numbers.",
            "Nothing else.",
        ),
    )


def _speedy():
    visit("fig16-escape")
    return Made(
        verdict=Verdict.REPRODUCED,
        value="<b>bold</b> & \"quoted\" 'text'",
        error="<script>alert(1)</script>",
        tolerance="a < b",
        explanation="</details><img src=x onerror=alert(1)>",
    )


def _vague():
    visit("fig16-vague")
    return Made(
        verdict=Verdict.UNTESTABLE,
        value="no value: the initial state is not given",
        error="none",
        tolerance="none",
        explanation="The text does not say from which state the simulation starts.",
        because="the initial state is not given.",
    )


CLAIMS = (
    made(
        "fig16-speed",
        "Fig. 16, Eq. 54",
        "The velocity is asymptotically linear in the coupling.",
        printed="“the scaling is asymptotically linear”",
        recorded=Verdict.NOT_REPRODUCED,
        command="fronts check fig16-speed --out report",
        evidence=_speed,
        methods=("derivative of the closed form", "slope of the simulated velocities"),
    ),
    made(
        "fig16-misprint",
        "Eq. 12",
        "The energy is a² − b².",
        printed="a² − b²",
        recorded=Verdict.CORRECTED,
        command="fronts check fig16-misprint",
        evidence=_misprint,
        methods=("computer algebra", "random numbers to 50 digits"),
    ),
    made(
        "fig16-escape",
        "Eqs. 1–3 & <4>",
        'Markup such as </summary> & <b id="x"> stays text.',
        printed="<u>1</u>",
        recorded=Verdict.REPRODUCED,
        command="echo '<i>' && echo \"&\"",
        evidence=_speedy,
        methods=("<i>one</i>", "two & three"),
    ),
    made(
        "fig16-vague",
        "Section 5",
        "The front settles after a short transient.",
        printed="“a short transient”",
        recorded=Verdict.UNTESTABLE,
        command="fronts check fig16-vague",
        evidence=_vague,
        methods=("reading of the text", "search of the caption"),
    ),
)
