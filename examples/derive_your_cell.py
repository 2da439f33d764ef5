"""The averaged equation of an oscillator of your own, derived and checked."""

import fronts as fr


def main(path: str | None = None) -> float:
    """Return the amplitude of its largest cycle; write the derived equation to a file."""
    cell = fr.derive_cell("1 - 3*y**2 + y**4/2")
    if path is not None:
        with open(path, "w", encoding="utf-8") as file:
            file.write(str(cell.damping_mean))
    import sympy as sp

    (s,) = cell.damping_mean.free_symbols
    return float(max(sp.sqrt(root) for root in sp.solve(cell.damping_mean, s)))


if __name__ == "__main__":
    print(main("derive_your_cell.txt"))
