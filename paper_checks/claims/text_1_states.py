"""What the text of sections 1.2 and 1.3 asserts about the states and fronts of Model I."""

from __future__ import annotations

from paper_checks.following import following

CLAIMS = (
    following(
        "text-start-matters",
        "Section 1.2",
        "Initial conditions and coupling decide between breather and front.",
        "fig03-breather",
        "fig03-front",
    ),
    following(
        "text-coupling-promotes",
        "Section 1.3, before Fig. 4",
        "A stronger coupling promotes propagation.",
        "fig05-regions",
    ),
    following(
        "text-critical-divides",
        "Caption of Fig. 4",
        "Below the critical coupling a breather is expected, above it a front.",
        "fig05-regions",
        "fig06-threshold",
    ),
    following(
        "text-after-front",
        "Section 1.3, after Fig. 5",
        "After propagation all oscillators of a finite chain are in stick-slip or, at higher "
        "speed, in steady sliding.",
        "fig05-regions",
        "fig05-nucleation",
    ),
)
