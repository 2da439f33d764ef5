"""How many points the rules of quadrature take, how far they reach, what they say was added up."""

import pytest

from theory.piecewise.profile import ProfileGrid, front_profile, smooth_number
from theory.piecewise.sums.result import PrecisionError


@pytest.mark.parametrize("extent", [60.0, 200.0])
def test_the_lattice_of_the_profile_is_centred_and_holds_the_extent(extent: float) -> None:
    grid = ProfileGrid.make(0.3, 0.01, extent, 0.1)
    zeta, phi = grid.on_lattice(2)
    assert zeta[0] == -(grid.points // 2)
    assert zeta[-1] == grid.points // 2 - 0.5
    assert zeta[0] <= -extent
    assert zeta[-1] >= extent
    # the middle of the front, where phi falls from 1 to 0, is at 0
    assert abs(phi[zeta == -40.0] - 1) < 1e-6
    assert abs(phi[zeta == 40.0]) < 1e-6


def test_the_points_of_the_profile_are_the_fewest_of_their_kind() -> None:
    def kind(n: int) -> bool:
        twos = n & -n
        return n % 2 == 0 and n // twos in (1, 3, 5, 9, 15)

    for least in range(8, 600):
        fewest = next(n for n in range(least, 4 * least) if kind(n))
        assert smooth_number(least) == fewest


def test_a_profile_of_more_than_two_million_points_is_refused() -> None:
    with pytest.raises(PrecisionError, match="more than 2097152"):
        front_profile([2.5e6], 0.3, 0.5)
