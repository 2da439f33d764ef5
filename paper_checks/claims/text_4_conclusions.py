"""What the conclusions assert."""

from __future__ import annotations

from paper_checks.claims._text import untestable
from paper_checks.following import following

CLAIMS = (
    following(
        "text-end-similar",
        "Conclusions",
        "The two models are different, but their dynamical behaviour is very similar.",
        "models",
    ),
    following(
        "text-end-breathers",
        "Conclusions",
        "In both models discrete breathers are observed at low coupling.",
        "fig03-breather",
        "fig07-localised",
    ),
    following(
        "text-end-loss",
        "Conclusions",
        "With more coupling the breather loses stability and limit cycles spread in the chain.",
        "text-coupling-promotes",
        "text-two-values",
        "fig12-steady",
    ),
    following(
        "text-end-nucleation",
        "Conclusions",
        "In both models breathers give way to propagation through a nucleation process.",
        "text-to-larger",
        "text-friction-nucleation",
    ),
    following(
        "text-end-velocity",
        "Conclusions",
        "From a critical coupling on the velocity scales linearly with the coupling.",
        "fig06-linear",
        "fig13-scaling",
    ),
    following(
        "text-end-topology",
        "Conclusions",
        "In both models the isolated oscillator has a fixed point inside two limit cycles, the "
        "inner one unstable, the outer one stable.",
        "text-inner-cycle",
        "text-cell",
        weight=1,
    ),
    untestable(
        "text-end-origin",
        "Conclusions",
        "The likeness of the models originates from the likeness of their cells.",
        "A cause is named, and no experiment that could separate it from others: both chains have "
        "also the same coupling, the same ends and the same kind of start.",
    ),
    untestable(
        "text-end-robust",
        "Conclusions",
        "Models of similar topology can be expected to show the same features.",
        "It is an expectation about models that are not named; see text-abstract-others.",
    ),
)
