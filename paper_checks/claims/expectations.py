"""Sentences that no computation of these two models can judge, and why."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from paper_checks.claim import Claim, Method, Repeat, Ruling, Verdict
from paper_checks.ruling import untestable


@dataclass(frozen=True, kw_only=True)
class Missing:
    """What the text would have to say to be tested."""

    reason: str
    remark: str = ""


def rule(e: Missing) -> Ruling:
    """Rule: nothing was computed, so the verdict is what the reason says."""
    return untestable(e.reason)


def _claim(
    key: str, place: str, quote: str, statement: str, *, reason: str, remark: str = "",
    repeats: tuple[Repeat, ...] = (),
) -> Claim:  # fmt: skip
    return Claim(
        key=key,
        place=place,
        quote=quote,
        statement=statement,
        recorded=Verdict.UNTESTABLE,
        command=f"fronts check {key}",
        evidence=partial(Missing, reason=reason, remark=remark),
        rule=rule,
        methods=(Method("reading of the text", f"{__name__}:rule"),),
        repeats=repeats,
        weight=0,
    )


CLAIMS = (
    _claim(
        "expect-others",
        "Abstract",
        "dynamical features similar to what was demonstrated in this work are expected for models "
        "that are different quantitatively but preserve the same single-unit topology",
        "Other models with the same single-unit topology are expected to behave alike.",
        reason="it is an expectation about models that are not named.",
        repeats=(
            Repeat("Conclusions", "similar dynamical features […] are expected for models that are "
                   "different quantitively but preserve the same single-unit topology"),
            Repeat("Conclusions", "a possible robustness of models with similar topology"),
        ),
    ),
    _claim(
        "expect-origin",
        "Conclusions",
        "the similarities between the two models originates from the similar dynamical behavior of "
        "the unit cell",
        "The likeness of the models originates from that of their cells.",
        reason="a cause is named, and no experiment that could separate it from others, such as "
        "the common coupling and ends.",
    ),
    _claim(
        "expect-equivalence",
        "Section 2.3.2",
        "These two similarities imply the equivalence of the two models in terms of dynamical "
        "behavior",
        "The likeness of Figs. 17 and 18 to Figs. 13 and 14 implies equivalence.",
        reason="what equivalence in terms of dynamical behavior means is not said.",
        remark="One of the two similarities does not hold (fig17-linear), the other does "
        "(fig18-alike).",
    ),
    _claim(
        "expect-experiments",
        "Introduction",
        "rupture fronts which transverse the interface with velocity spanning roughly two orders "
        "of magnitude",
        "Rupture fronts cross real interfaces at velocities over two orders of magnitude.",
        reason="this is about experiments of others, and neither model is calibrated to them.",
    ),
    _claim(
        "expect-irregular",
        "Introduction",
        "with periodic and irregular stick-slip motion",
        "The localised patterns of [18] had periodic and irregular motion.",
        reason="it is about the model of [18], whose parameters and starts are not repeated here.",
    ),
    _claim(
        "expect-two-dimensions",
        "Introduction",
        "These propagating stick-slip states have been observed also by Costagliola at al. [20]",
        "Propagating stick-slip was also observed in two dimensions.",
        reason="it is about a model of others, and neither model of the paper has two dimensions.",
    ),
    _claim(
        "expect-difficult",
        "Introduction",
        "it is difficult to obtain analytical approximation of the dynamical states in "
        "friction-excited systems",
        "Analytical approximations are difficult for friction-excited systems.",
        reason="it is a judgement of difficulty.",
        remark="Parts of the friction cell have closed forms, such as the velocity at which steady "
        "sliding becomes stable (fig02-regions).",
        repeats=(Repeat("Section 2", "The smoothness of Model II allows application of several "
                        "analytical techniques"),),
    ),
    _claim(
        "expect-starts",
        "Section 1.2, after Eq. (7)",
        "initial conditions are selected close to stick-slip limit cycle of the isolated unit cell",
        "Excited oscillators start close to the cycle, the others near steady sliding.",
        reason="how close is not said, and the initial displacements are missing.",
        remark="Each of our thresholds names its start: the upper turning point of the cycle, "
        "at rest.",
    ),
    _claim(
        "expect-simplest",
        "Section 2, before Eq. (8)",
        "the isolated VdP oscillator is probably the simplest available model",
        "The Van der Pol cell is probably the simplest bistable model.",
        reason="what counts as simple is not said.",
    ),
    _claim(
        "expect-procedure",
        "Section 2.2",
        "It is possible, although somewhat more complicated, to study other breather "
        "configurations through the same procedure",
        "Other breathers could be studied by the procedure of 2.1.",
        reason="it is said to be possible and not carried out.",
    ),
    _claim(
        "expect-forcing",
        "Section 2.3.1",
        "Here $\\eta$ is in a sense the equivalent forcing parameter parallel to $\\tilde{v}_d$",
        "η is in a sense the equivalent of the belt velocity.",
        reason="the sense is not given.",
        remark="What can be compared, the two maps, is judged under fig15-alike.",
    ),
    _claim(
        "expect-resembles",
        "Section 2.3.2, before Eq. (44)",
        "The equation somewhat resembles the Atkinson-Cabrera equations [26]",
        "(44) somewhat resembles the Atkinson-Cabrera equations.",
        reason="how much alike is not said.",
        remark="(44) is of first order in time and complex, and has no energy; the chains cited "
        "are of second order and real.",
    ),
)  # fmt: skip
