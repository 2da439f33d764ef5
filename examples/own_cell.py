"""A cell of your own in ten lines: a Duffing-Van der Pol chain from its equation, and its front."""

import fronts as fr


def main(path: str | None = None) -> float:
    """Return the velocity of its front; draw the arrivals to a file."""
    chain = fr.OscillatorChain(
        damping="1 - a*y**2 + b*y**4", stiffness="y + k*y**3", c=2,
        values={"a": 4, "b": 0.5, "k": 0.0005},
    )  # fmt: skip
    front = fr.measure_front(chain)
    if path is not None:
        front.plot().figure.savefig(path)
    assert front.v is not None
    return front.v


if __name__ == "__main__":
    print(main("own_cell.svg"))
