"""Front velocity against coupling in the piecewise-linear chain (Eq. 54), with every branch."""

import numpy as np

import fronts as fr


def main(path: str | None = None) -> float:
    """Return the fastest velocity at the largest coupling; draw the curve to a file."""
    curve = fr.kinetic_relation(c=np.linspace(0.40, 1.0, 61), eta=0.03125)
    axes = curve.plot()
    if path is not None:
        axes.figure.savefig(path)
    return float(curve.points[-1].branches[-1].v)


if __name__ == "__main__":
    print(main("kinetic_curve.svg"))
