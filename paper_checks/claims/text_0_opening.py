"""What the abstract and the introduction assert about the dynamics."""

from __future__ import annotations

from paper_checks.claims._text import untestable
from paper_checks.following import following

CLAIMS = (
    following(
        "text-abstract-breathers",
        "Abstract",
        "Both models have discrete breathers at low coupling.",
        "fig03-breather",
        "fig07-localised",
    ),
    following(
        "text-abstract-fronts",
        "Abstract",
        "At stronger coupling high-amplitude limit cycles propagate along both chains.",
        "fig03-front",
        "fig12-steady",
    ),
    following(
        "text-abstract-nucleation",
        "Abstract",
        "In both models breathers give way to propagation through a nucleation process.",
        "text-to-larger",
        "text-friction-nucleation",
    ),
    following(
        "text-abstract-velocity",
        "Abstract",
        "In both models the velocity scales linearly with the coupling above a critical one.",
        "fig06-linear",
        "fig13-scaling",
        weight=1,
    ),
    following(
        "text-abstract-similar",
        "Abstract",
        "The two models show very similar dynamical features.",
        "models",
    ),
    untestable(
        "text-abstract-others",
        "Abstract",
        "Other models with the same single-unit topology will show similar features.",
        "It is an expectation about models that are not named. One model of the paper itself "
        "counts against a part of it: the velocity of (44) does not scale linearly "
        "(fig17-linear); but (44) fixes the phase of the cycle, so its unit is not the same.",
    ),
    untestable(
        "text-intro-fronts",
        "Introduction",
        "Rupture fronts cross real interfaces at velocities over two orders of magnitude.",
        "This is about experiments of others, cited as [3]; neither model is calibrated to them.",
    ),
    following(
        "text-intro-localised",
        "Introduction",
        "Weakly coupled chains of frictional oscillators can have localised stick-slip.",
        "fig03-breather",
    ),
    untestable(
        "text-intro-irregular",
        "Introduction",
        "The localised patterns of [18] had periodic and irregular stick-slip motion.",
        "It is about the model of [18], whose parameters and starts are not repeated here. That "
        "many patterns coexist is judged under text-intro-bistable.",
    ),
    untestable(
        "text-intro-two-dimensions",
        "Introduction",
        "Propagating stick-slip was also observed in a model in two dimensions [20].",
        "It is about a model of others; neither model of the paper has two dimensions.",
    ),
    untestable(
        "text-intro-difficult",
        "Introduction",
        "Analytical approximations are difficult for friction-excited systems.",
        "It is a judgement of difficulty. Parts of the friction cell have closed forms, such as "
        "the speed at which steady sliding becomes stable (fig02-regions).",
    ),
    following(
        "text-intro-regimes",
        "Introduction",
        "Both models have stable regimes of localised solutions and of travelling waves.",
        "fig03-breather",
        "fig03-front",
        "fig07-localised",
        "fig12-steady",
    ),
    following(
        "text-intro-nucleation",
        "Introduction",
        "In both models the transition occurs through a nucleation process.",
        "text-to-larger",
        "text-friction-nucleation",
    ),
    following(
        "text-intro-velocity",
        "Introduction",
        "The velocity can be nearly linearly scaled with the coupling coefficient.",
        "fig06-linear",
        "fig13-scaling",
    ),
)
