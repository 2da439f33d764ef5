"""A harmonic force F cos(ωt + phase) on chosen sites."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from theory.arrays import FloatArray
from theory.chains.site_text import MAX_LISTED, read_sites
from theory.parameters import ParameterError, count_within, real_number

MAX_FORCE, MAX_FREQUENCY = 1e6, 1e6

_FORM = "amplitude,frequency,phase@sites"
_EXAMPLE = "write it as 0.1,1.2@1,4:6 or 0.1,1.2,0.5@all"
_KEYS = ("amplitude", "frequency", "phase", "sites")


@dataclass(frozen=True, kw_only=True)
class Drive:
    """One harmonic force; dimensionless.

    Attributes
    ----------
    amplitude, frequency, phase : float
        F, ω and the phase at t = 0, in radians.
    sites : tuple of int
        Sites on which it acts, counted from 1; empty for all.
    """

    amplitude: float
    frequency: float
    phase: float
    sites: tuple[int, ...]

    def __str__(self) -> str:
        """Return the force as text, from which it can be read back exactly."""
        sites = ",".join(map(str, self.sites)) or "all"
        return f"{self.amplitude!r},{self.frequency!r},{self.phase!r}@{sites}"

    def amplitudes(self, sites: int) -> FloatArray:
        """Return F at every site, shape (N,)."""
        found = np.zeros(sites)
        found[np.array(self.sites) - 1 if self.sites else slice(None)] = self.amplitude
        return found


def read_drives(given: Any, sites: int) -> tuple[Drive, ...]:
    """Return the forces that texts or mappings describe.

    Parameters
    ----------
    given : str, mapping, Drive, or sequence of them
        A text has the form ``amplitude,frequency[,phase]@sites`` with sites as ``1,4:6`` or
        ``all``. A mapping has these keys; its sites are numbers or such a text.
    sites : int
        Number of sites N.

    Raises
    ------
    ParameterError
        If a force is given in none of these forms, or a number is out of range.

    Examples
    --------
    >>> [str(each) for each in read_drives("0.1,1.2@1,4:6", 9)]
    ['0.1,1.2,0.0@1,4,5,6']
    """
    single = isinstance(given, (str, Mapping, Drive))
    every = [given] if single else given
    if not isinstance(every, Sequence):
        raise _refused(repr(given)[:60])
    return tuple(_read(each, sites) for each in every)


def _refused(given: object) -> ParameterError:
    return ParameterError("drive", given, _FORM, _EXAMPLE)


def _read(given: Any, sites: int) -> Drive:
    if isinstance(given, Drive):
        given = str(given)
    if isinstance(given, str):
        numbers, _, places = given.partition("@")
        parts = numbers.split(",")
        if not places or len(parts) not in (2, 3):
            raise _refused(repr(given))
        values = [*parts, "0"][:3]
        named: Mapping[str, Any] = dict(zip(_KEYS, [*values, places], strict=True))
    elif isinstance(given, Mapping) and {*_KEYS} - {"phase"} <= {*given} <= {*_KEYS}:
        named = {"phase": 0.0, **given}
    else:
        raise _refused(repr(given)[:60])
    limits = (MAX_FORCE, MAX_FREQUENCY, MAX_FREQUENCY)
    checked = [
        real_number(
            f"{key} of the drive", _number(named[key]), -high, high, "give a number in this range"
        )
        for key, high in zip(_KEYS, limits, strict=False)
    ]
    return Drive(
        amplitude=checked[0],
        frequency=checked[1],
        phase=checked[2],
        sites=_places(named["sites"], sites),
    )


def _number(given: Any) -> Any:
    if not isinstance(given, str):
        return given
    try:
        return float(given)
    except ValueError:
        raise _refused(repr(given)) from None


def _places(given: Any, sites: int) -> tuple[int, ...]:
    """Return the sites, counted from 1, in ascending order; an empty tuple means all."""
    if isinstance(given, str):
        if given.strip() == "all":
            return ()
        try:
            given = read_sites(given)
        except ValueError:
            raise _refused_sites(given) from None
    if not isinstance(given, (Sequence, np.ndarray)) or len(given) == 0:
        raise _refused_sites(given)
    return tuple(sorted({count_within("site of the drive", n, 1, sites) for n in given}))


def _refused_sites(given: object) -> ParameterError:
    allowed = f"1,4:6, of at most {MAX_LISTED} sites, or all"
    return ParameterError("sites of the drive", repr(given)[:60], allowed, _EXAMPLE)
