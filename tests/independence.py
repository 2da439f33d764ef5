"""A check whether the methods of a claim share a solver, by following the imports of their code.

A solver is any code that computes: a stepper, a sum, a search. Two methods may share what
defines the problem, but not how it is solved: parameters and their checks, the model's own numbers
(amplitudes of its cycles, its friction law), starts, and names of outcomes (`DEFINITIONS`).
"""

from __future__ import annotations

from paper_checks.claim import Method
from verification.execution.imports import closure

PACKAGES = ("theory", "derivations", "verification", "paper_checks")

DEFINITIONS = (
    "theory.arrays",
    "theory.compiled_code",
    "theory.compiler",
    "theory.interruption",
    "theory.parameters",
    "theory.result",
    "theory.status",
    "theory.cells",
    "theory.chains",
    "verification.runs.excite",
    "verification.steppers.rows",
    "verification.execution",
    "verification.thresholds.result",
    "theory.piecewise.dispersion",
    "theory.piecewise.sums.result",
)
"""Modules or packages that define problems and contain no solver, each for a reason: array types;
interrupts from the keyboard; the checks of parameters; the two cells; the two chains; where a run
starts; which sites form a nucleus; the vector field itself, and its layout in rows; compiling,
storing and sweeping; the dispersion relation (50) as printed; and the form of a result."""


FORMS = ("theory.result", "verification.runs.excite", "verification.breathers.own")
"""Modules that are not followed. The base of results loads pictures by name, and nothing that
computes. Where a run starts is part of the problem, even if it is a point of a cycle. Breathers of
user-defined chains belong to models that no claim is about (which a test verifies)."""


def solvers(method: Method) -> frozenset[str]:
    """Return the modules with solvers that the code of a method imports, including its own."""
    found = closure(method.module, PACKAGES, without=FORMS)
    return frozenset(
        name
        for name, path in found.items()
        if path.name != "__init__.py"
        and not any(name == each or name.startswith(f"{each}.") for each in DEFINITIONS)
    )
