"""Nuclei: the number of excited sites, their place, and the phase steps between them.

A pattern has one sign per link: ``+`` if the next site leads by π/2, ``-`` if it lags by π/2, ``0``
for sites in phase, ``x`` for sites in antiphase. To leading order in c the phases inside a nucleus
of equal amplitudes obey θ_n' = (c/2)(2 - cos(θ_{n-1} - θ_n) - cos(θ_{n+1} - θ_n)), so that a common
frequency requires cos(step) = K, 0, K, 0, …, K along the links. A nucleus of odd size has K = 0:
every step is ±π/2, and no odd nucleus of three or more sites remains in phase. In a nucleus of even
size, K is free at this order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from theory.arrays import BoolArray, ComplexArray, FloatArray
from theory.chains.chain import MAX_SITES
from theory.chains.vdp import VanDerPolChain
from theory.parameters import ParameterError, count_within, need_instance
from theory.status import Status

STEPS = {"+": 0.5 * np.pi, "-": -0.5 * np.pi, "0": 0.0, "x": np.pi}
_SIGNS = {round(2.0 * step / np.pi) % 4: sign for sign, step in STEPS.items()}
"""The sign of each number of quarter turns, from 0 to 3."""
MARGIN = 7
"""Default number of sites at rest on each side; a tail of ratio 0.25 falls to 6e-5 there."""


class Place(Status):
    """The place of the nucleus in the chain."""

    BULK = "bulk", "The nucleus is in the middle of the chain."
    EDGE = "edge", "The nucleus is the first sites of the chain."


@dataclass(frozen=True)
class Nucleus:
    """A nucleus of excited sites.

    Attributes
    ----------
    size : int
        Number of excited sites, at least 1.
    pattern : str
        One of ``+-0x`` for each of the ``size - 1`` links; if empty, all sites are in phase. For
        three or more sites in phase, the breather is the one to which they relax.
    place : Place
        ``bulk``: in the middle of the chain; ``edge``: at its beginning.
    relaxed_from : str
        The pattern that was requested, if this nucleus is the one to which it relaxes; else empty.

    Raises
    ------
    ParameterError
        If the pattern does not fit the size.

    Examples
    --------
    >>> Nucleus(3, "-+").phases().round(3).tolist()
    [0.0, -1.571, 0.0]
    >>> Nucleus(3).pattern
    '00'
    """

    size: int
    pattern: str = ""
    place: Place = Place.BULK
    relaxed_from: str = field(
        default="", compare=False, repr=False, kw_only=True, metadata={"option": False}
    )

    def __post_init__(self) -> None:
        size = count_within("nucleus", self.size, 1, MAX_SITES, "excite a site")
        object.__setattr__(self, "size", size)
        if self.pattern == "":
            object.__setattr__(self, "pattern", "0" * (size - 1))
        signs = self.pattern if isinstance(self.pattern, str) else "none"
        if len(signs) != self.size - 1 or set(signs) - set(STEPS):
            raise ParameterError(
                "pattern",
                repr(self.pattern),
                f"{self.size - 1} of the signs {' '.join(STEPS)}, one for each link of the nucleus",
                "give one sign for each link",
            )
        object.__setattr__(self, "place", Place(self.place))
        need_instance("relaxed_from", self.relaxed_from, (str,), "give a pattern, or leave it out")

    def to_dict(self) -> dict[str, Any]:
        """Return size, pattern and place, and the pattern from which it relaxed, if it did."""
        found = {"size": self.size, "pattern": self.pattern, "place": self.place.value}
        return found | ({"relaxed_from": self.relaxed_from} if self.relaxed_from else {})

    @property
    def in_phase(self) -> bool:
        """Whether every phase step is zero."""
        return set(self.pattern) <= {"0"}

    def relaxed(self, sites: int) -> Nucleus:
        """Return the nucleus to which three or more sites in phase in the bulk relax.

        Other nuclei are returned unchanged; a chain whose sites are all excited remains in phase.

        Examples
        --------
        >>> nucleus = Nucleus(3).relaxed(15)
        >>> nucleus.pattern, nucleus.relaxed_from
        ('-+', '00')
        >>> Nucleus(3).relaxed(3).pattern
        '00'
        """
        stays = self.size < 3 or self.size == sites or self.place is Place.EDGE
        if stays or not self.in_phase:
            return self
        return replace(self, pattern=outward_pattern(self.size), relaxed_from=self.pattern)

    def found_in(self, waves: ComplexArray, level: float) -> Nucleus | None:
        """Return the nucleus of a state to which this one has led; None if it has no name here.

        It consists of the sites above a level, and each phase step is the nearest quarter turn. It
        has no name if these sites are not adjacent, or not in this place of the chain.

        Parameters
        ----------
        waves : complex array, shape (N,)
            Amplitude and phase of every site.
        level : float
            Amplitude above which a site belongs to the nucleus.

        Examples
        --------
        >>> state = np.array([0.1, 2.0, 2.0j, 0.1])
        >>> found = Nucleus(2, "-").found_in(state, 1.0)
        >>> found.pattern, found.relaxed_from
        ('+', '-')
        >>> Nucleus(2, "-").found_in(state[::-1], 1.0) == Nucleus(2, "-")
        True
        >>> print(Nucleus(3, "--").found_in(np.array([2.0, 0.1, 0.1, 0.1, 0.1]), 1.0))
        None
        """
        (above,) = np.nonzero(np.abs(waves) > level)
        if above.size == 0 or above[-1] - above[0] >= above.size:
            return None
        steps = np.angle(waves[above[1:]] / waves[above[:-1]]) / (0.5 * math.pi)
        pattern = "".join(_SIGNS[round(step) % 4] for step in steps.tolist())
        if pattern == self.pattern:
            found = self
        else:
            before = self.relaxed_from or self.pattern
            found = replace(self, size=above.size, pattern=pattern, relaxed_from=before)
        return found if found.first(waves.size) == above[0] else None

    def phases(self) -> FloatArray:
        """Return the phases θ_n of the excited sites, the first one zero."""
        return np.concatenate([[0.0], np.cumsum([STEPS[sign] for sign in self.pattern])])

    def quarter_turns(self) -> list[int]:
        """Return the phases of the excited sites, rounded to whole quarter turns.

        Examples
        --------
        >>> Nucleus(3, "-+").quarter_turns()
        [0, -1, 0]
        """
        return [round(turn) for turn in (self.phases() / (0.5 * math.pi)).tolist()]

    def excited(self, sites: int) -> tuple[int, ...]:
        """Return the excited sites of a chain, counted from 1.

        Raises
        ------
        ParameterError
            If the nucleus is wider than the chain.

        Examples
        --------
        >>> Nucleus(3, "00").excited(31), Nucleus(2, "0", Place.EDGE).excited(31)
        ((15, 16, 17), (1, 2))
        """
        first = self.first(sites)
        return tuple(range(first + 1, first + self.size + 1))

    def outside(self, sites: int) -> BoolArray:
        """Return which sites of a chain are not excited, shape (N,).

        Examples
        --------
        >>> Nucleus(2, "0", Place.EDGE).outside(3).tolist()
        [False, False, True]
        """
        mask = np.ones(sites, dtype=np.bool_)
        mask[self.first(sites) : self.first(sites) + self.size] = False
        return mask

    def first(self, sites: int) -> int:
        """Return the index of the first excited site in a chain.

        Raises
        ------
        ParameterError
            If the nucleus is wider than the chain.
        """
        if self.size > sites:
            raise ParameterError(
                "nucleus", self.size, f"at most the {sites} sites of the chain", "take a longer one"
            )
        return 0 if self.place is Place.EDGE else (sites - self.size) // 2

    def centre(self, sites: int) -> int:
        """Return the index of the central excited site, or of the left one of two."""
        return self.first(sites) + (self.size - 1) // 2

    def outward(self, sites: int) -> int:
        """Return the index of the central excited site, or right one of two; at an edge, 0."""
        return 0 if self.place is Place.EDGE else self.first(sites) + self.size // 2

    def mirrored(self, sites: int) -> bool:
        """Return whether reflection about the middle of the chain leaves the nucleus unchanged."""
        flipped = self.pattern[::-1].translate(str.maketrans("+-", "-+"))
        return self.place is Place.BULK and (sites - self.size) % 2 == 0 and flipped == self.pattern

    def envelope(self, chain: VanDerPolChain) -> ComplexArray:
        """Return the state at c = 0: |φ_s| with these phases on the nucleus, rest elsewhere."""
        phi = np.zeros(chain.sites, dtype=complex)
        first = self.first(chain.sites)
        phases = self.phases() - self.phases()[self.centre(chain.sites) - first]
        phi[first : first + self.size] = chain.stable_amplitude * np.exp(1j * phases)
        return phi


def outward_pattern(size: int) -> str:
    """Return the pattern to which sites in phase relax while mirror symmetry is preserved.

    For odd sizes, each site leads its inner neighbour by π/2; two sites remain in phase.

    Raises
    ------
    ParameterError
        For even sizes from 4, for which no common frequency exists: mirror symmetry would require
        K = 1 on the middle link and 0 next to it.

    Examples
    --------
    >>> outward_pattern(5), outward_pattern(2)
    ('--++', '0')
    """
    if size == 2:
        return "0"
    if size % 2 == 0:
        lopsided = "+" * (size // 2) + "-" * (size // 2 - 1)
        raise ParameterError(
            "nucleus", size, "odd, or 2, for a breather to which sites in phase relax",
            f"name a pattern of + and -, as '{lopsided}'",
        )  # fmt: skip
    half = (size - 1) // 2
    return "-" * half + "+" * half


def sites_for(size: int, margin: int = MARGIN) -> int:
    """Return the length of a chain with ``margin`` sites on each side of a nucleus."""
    return size + 2 * margin
