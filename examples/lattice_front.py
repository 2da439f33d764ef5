"""A front on a square lattice as a film, and how its velocity depends on the direction."""

import fronts as fr


def main(path: str | None = None) -> float:
    """Return velocity along the diagonal over that along a row; write a film to a file."""
    lattice = fr.OscillatorChain(
        damping=0, stiffness="y*(1 - y)*(alpha - y)", values={"alpha": 0.2}, overdamped=True,
        c=0.06, coupling="square", sites=(41, 41),
    )  # fmt: skip
    front = fr.measure_front(lattice, directions=8)
    if path is not None:
        middle = [n + 1 for n in range(lattice.sites) if front.detail.distances[n] < 3.5]
        run = fr.simulate(
            lattice, fr.excite(lattice, middle), t_end=200, samples=20, estimate_error=False
        )
        fr.animate(run, path)
    return float(front.detail.velocities[1] / front.detail.velocities[0])


if __name__ == "__main__":
    print(main("lattice_front.gif"))
