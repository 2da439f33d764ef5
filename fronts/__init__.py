"""Excitation fronts in self-excited chains: theory, direct simulation, derivations, verdicts.

>>> import fronts as fr
>>> fr.kinetic_relation(c=0.5, eta=0.03125).status.value
'propagating'

Each name is imported when it is first used, so that ``import fronts`` takes almost no time.
A chain (`VdpChain`, `AveragedChain`, `PiecewiseChain`, `FrictionChain`, or `OscillatorChain` for a
user-defined one) is a set of parameters, which are checked on construction. Functions take a chain
or numbers and return a result: a frozen dataclass with ``error``, ``status`` and ``to_dict()`` and,
where applicable, ``plot()``, ``to_pandas()`` and ``to_xarray()``. Invalid input raises
`ParameterError` or, in derivations, `DerivationInputError`; both are a ``ValueError`` whose message
names the quantity, its value, the allowed range and the remedy. The command ``fronts`` provides the
same functions in a shell.
"""

from __future__ import annotations

import ast
import importlib
import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from derivations.algebra.errors import DerivationInputError as DerivationInputError
    from fronts.animation import animate as animate
    from fronts.branches import follow_breather as follow_breather
    from fronts.branches import follow_front as follow_front
    from fronts.checking import derivation as derivation
    from fronts.checking import derive_cell as derive_cell
    from fronts.checking import judge as judge
    from fronts.checking import robustness as robustness
    from fronts.piecewise.kinetic_relation import kinetic_relation as kinetic_relation
    from fronts.piecewise.profile import front_profile as front_profile
    from fronts.piecewise.roots import roots as roots
    from fronts.piecewise.sigma import sigma as sigma
    from theory.cells.friction import FrictionCell as FrictionCell
    from theory.chains.friction import FrictionChain as FrictionChain
    from theory.chains.nucleus import Nucleus as Nucleus
    from theory.chains.oscillator import OscillatorChain as OscillatorChain
    from theory.chains.piecewise import PiecewiseChain as PiecewiseChain
    from theory.chains.vdp import AveragedChain as AveragedChain
    from theory.chains.vdp import VdpChain as VdpChain
    from theory.parameters import ParameterError as ParameterError
    from theory.parameters import RunError as RunError
    from theory.piecewise.sums.result import PrecisionError as PrecisionError
    from theory.result import Result as Result
    from verification.breathers.breather import breather as breather
    from verification.cells.cell import cell as cell
    from verification.execution.progress import Progress as Progress
    from verification.execution.sweep import SweepError as SweepError
    from verification.execution.sweep import sweep as sweep
    from verification.fronts.measure import measure_front as measure_front
    from verification.maps.state_map import state_map as state_map
    from verification.runs.averaging_error import averaging_error as averaging_error
    from verification.runs.ensemble import ensemble as ensemble
    from verification.runs.excite import excite as excite
    from verification.runs.simulate import simulate as simulate
    from verification.thresholds.threshold import threshold as threshold

    __version__: str


def _public_names() -> dict[str, str]:
    """Return the names imported above and their modules, read from the source of this file."""
    tree = ast.parse(Path(__file__).read_text(encoding="utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    imports = (node for node in block.body if isinstance(node, ast.ImportFrom))
    return {alias.name: str(node.module) for node in imports for alias in node.names}


_HOMES = _public_names()
"""The module of each public name, imported when the name is first used."""

__all__ = [*_HOMES, "__version__"]  # noqa: PLE0604

_PACKAGES = ("theory", "derivations", "verification", "paper_checks")
"""The other packages of the toolkit, which are in the same folder as this one."""

if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """Import a public name on first use (PEP 562)."""
        if name == "__version__":
            value: Any = _version()
        elif name in _HOMES:
            value = getattr(importlib.import_module(_HOMES[name]), name)
        else:
            raise AttributeError(f"module 'fronts' has no attribute '{name}'")
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted(__all__)


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("excitation-fronts")
    except PackageNotFoundError:
        return "0+unknown"


def _refuse_hidden() -> None:
    """Refuse to start if a file of the user would be imported in place of a package of the toolkit.

    Raises
    ------
    ImportError
        If there is such a file or folder; the message names it in one sentence.
    """
    ours = Path(__file__).resolve().parents[1]
    for name in _PACKAGES:
        found = _place(name)
        if found is not None and found != ours / name:
            raise ImportError(
                f"{found} hides the package '{name}' of the toolkit fronts in {ours}: rename it, "
                "or start Python in another folder.",
                name=name,
                path=str(found),
            )


def _place(name: str) -> Path | None:
    """Return the folder of the package, or the file of the module, that would be imported."""
    try:
        spec = importlib.util.find_spec(name)
    except (ImportError, ValueError):
        return None
    if spec is None:
        return None
    if spec.submodule_search_locations:
        return Path(next(iter(spec.submodule_search_locations))).resolve()
    return None if spec.origin is None else Path(spec.origin).resolve()


_refuse_hidden()
