"""Whether the methods of a claim share an engine, by following the imports of their code.

An engine is code that computes: a stepper, a solver, a sum, a search. What two methods may share is
what says which problem they solve, not how: parameters and their checks, the model's own numbers
(amplitudes of its cycles, its friction law), starts, and names of outcomes (`DEFINITIONS`).
"""

from __future__ import annotations

from paper_checks.claim import Method
from verification.execution.imports import closure

PACKAGES = ("theory", "derivations", "verification", "paper_checks")

DEFINITIONS = (
    "theory.arrays",
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
"""Modules, or packages of them, that define problems and hold no engine, each for a reason: types
of arrays; the checks of parameters; the two cells; the two chains; where a run starts; which sites
form a nucleus; the vector field itself, and how it is laid out in rows; compiling, keeping and
sweeping; the dispersion relation (50) as printed; and the form of a result."""


FORMS = ("theory.result", "verification.runs.excite", "verification.breathers.own")
"""Modules that are not followed: the base of results loads pictures by name, and nothing that
computes; where a run starts is part of the problem, also where it is a point of a cycle; and
breathers of chains of one's own are of models that no claim is about (a test holds that)."""


def engines(method: Method) -> frozenset[str]:
    """Return the modules with engines that the code of a method imports, its own included."""
    found = closure(method.module, PACKAGES, without=FORMS)
    return frozenset(
        name
        for name, path in found.items()
        if path.name != "__init__.py"
        and not any(name == each or name.startswith(f"{each}.") for each in DEFINITIONS)
    )
