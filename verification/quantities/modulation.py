"""The modulation equations of one cell: symbolic, and not tested by the robustness table."""

from __future__ import annotations

from verification.quantities.quantity import Quantity

QUANTITIES = (
    Quantity(
        name="derivation",
        title="modulation equations of one cell",
        equation="(12), (43)",
        problems="derivation",
        reference="direct sampling of the cell; a true periodic orbit at small ε",
        accuracy=1e-6,
        default="multiple scales",
        useful=(1e-16, 1e-3),
    ),
)
