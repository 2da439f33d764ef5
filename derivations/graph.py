"""The graph of equations, from the models to (54): which follows from which, and its picture."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from html import escape

from derivations.algebra.steps import Derivation, Kind, Step

OUTLINES = {
    Kind.MODEL: ('stroke="#d55e00" stroke-width="4"', "model"),
    Kind.DEFINITION: ('stroke="#0072b2" stroke-width="2" stroke-dasharray="2 2"', "definition"),
    Kind.ANSATZ: ('stroke="#cc79a7" stroke-width="2" stroke-dasharray="6 3"', "ansatz"),
    Kind.DERIVED: ('stroke="#009e73" stroke-width="2"', "derived"),
}
"""Outline and legend of each kind: Okabe and Ito's colours, and lines that differ in grey too."""

_COLUMN, _ROW, _WIDTH, _HEIGHT = 78, 34, 46, 22


def key_of(step: Step) -> str:
    """Return the identifier of a step: its number, otherwise its name."""
    return str(step.number) if step.number is not None else step.name


@dataclass(frozen=True, kw_only=True)
class Graph:
    """Steps, and the steps from which each follows.

    Attributes
    ----------
    steps : mapping of str to Step
        The steps by `key_of`.
    sources : mapping of str to tuple of str
        Keys of the steps from which each follows directly.
    """

    steps: Mapping[str, Step]
    sources: Mapping[str, tuple[str, ...]]

    def numbered(self) -> dict[str, tuple[str, ...]]:
        """Return for each numbered equation the numbered or given steps from which it follows."""
        return {key: tuple(sorted(self._visible(key), key=_order))
                for key, step in self.steps.items() if step.number is not None}  # fmt: skip

    def _visible(self, key: str) -> set[str]:
        found: set[str] = set()
        for source in self.sources[key]:
            step = self.steps[source]
            if step.number is not None or not self.sources[source]:
                found.add(source)
            else:
                found |= self._visible(source)
        return found


def graph_of(derivations: Iterable[Derivation]) -> Graph:
    """Return the graph of some derivations, with everything from which they follow.

    Raises
    ------
    ValueError
        If two different steps have the same name.
    """
    steps: dict[str, Step] = {}
    waiting = [step for derivation in derivations for step in derivation.steps]
    while waiting:
        step = waiting.pop()
        key = key_of(step)
        if key not in steps:
            steps[key] = step
            waiting += step.sources
        elif step.number is None and steps[key].operation != step.operation:
            raise ValueError(f"two different steps are called '{key}'")
    sources = {key: tuple(dict.fromkeys(map(key_of, step.sources))) for key, step in steps.items()}
    return Graph(steps=steps, sources=sources)


def _order(key: str) -> tuple[int, str]:
    return (int(key), "") if key.isdigit() else (1000, key)


def svg(derivations: Iterable[Derivation]) -> str:
    """Draw the numbered equations and the unnumbered assumptions from which they follow.

    Each derivation has a band of its own, in which each column is one step further from what is
    given; arrows run from left to right. An arrow implied by a longer path is omitted.
    """
    made = tuple(derivations)
    graph = graph_of(made)
    edges = _reduced(graph.numbered())
    columns = _columns(edges)
    places, titles = _bands(made, edges, columns)
    width = _COLUMN * (max(columns.values()) + 1) + 20
    height = _ROW * (max(row for _, row in places.values()) + 1) + 50
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height:.0f}" '
        f'width="{width}" height="{height:.0f}" font-family="sans-serif" font-size="11" '
        'role="img">',
        "<title>The equations of the paper and what each follows from</title>",
        '<rect width="100%" height="100%" fill="white"/>',
        '<defs><marker id="tip" viewBox="0 0 6 6" refX="6" refY="3" markerWidth="5" '
        'markerHeight="5" orient="auto"><path d="M0 0L6 3L0 6z" fill="#777"/></marker></defs>',
    ]
    for row, title in titles:
        y = 20 + _ROW * row
        parts.append(f'<text x="14" y="{y + 4:.0f}" font-weight="bold">{escape(title)}</text>')
    for target, sources in edges.items():
        parts += [_arrow(places[source], places[target]) for source in sources]
    parts += [_box(graph, key, places[key]) for key in edges]
    parts += _legend(height)
    return "\n".join([*parts, "</svg>"])


def _reduced(numbered: Mapping[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
    """Omit edges implied by a longer path; add keys that are only sources."""
    edges = dict(numbered)
    for source in dict.fromkeys(source for found in numbered.values() for source in found):
        edges.setdefault(source, ())
    above: dict[str, set[str]] = {}

    def ancestors(key: str) -> set[str]:
        if key not in above:
            above[key] = set(edges[key]).union(*map(ancestors, edges[key]))
        return above[key]

    return {
        key: tuple(q for q in found if not any(q in ancestors(r) for r in found if r != q))
        for key, found in edges.items()
    }


def _columns(edges: Mapping[str, tuple[str, ...]]) -> dict[str, int]:
    found: dict[str, int] = {}

    def column(key: str) -> int:
        if key not in found:
            found[key] = 1 + max((column(source) for source in edges[key]), default=-1)
        return found[key]

    for key in edges:
        column(key)
    # What is given is placed just before its first use.
    for key in edges:
        users = [found[target] for target, sources in edges.items() if key in sources]
        if not edges[key] and users:
            found[key] = min(users) - 1
    return found


def _bands(
    derivations: tuple[Derivation, ...], edges: Mapping[str, tuple[str, ...]],
    columns: Mapping[str, int],
) -> tuple[dict[str, tuple[int, float]], list[tuple[float, str]]]:  # fmt: skip
    """Place each key in its column, in the band of the first derivation that contains it.

    Sources that the derivations take from elsewhere have a band of their own, above the others.
    """
    places: dict[str, tuple[int, float]] = {}
    titles: list[tuple[float, str]] = []
    top = 0.0
    bands = [(each.title, list(dict.fromkeys(map(key_of, each.steps)))) for each in derivations]
    own = {key for _, keys in bands for key in keys}
    bands.insert(0, ("From other derivations", [key for key in edges if key not in own]))
    for title, listed in bands:
        keys = [key for key in listed if key in edges and key not in places]
        if not keys:
            continue
        titles.append((top, title))
        taken: dict[int, int] = {}
        for key in sorted(keys, key=lambda key: (columns[key], *_order(key))):
            row = taken.get(columns[key], 0)
            taken[columns[key]] = row + 1
            places[key] = (columns[key], top + 0.8 + row)
        top += 1.0 + max(taken.values())
    return places, titles


def _centre(place: tuple[int, float]) -> tuple[float, float]:
    return 14 + _WIDTH / 2 + _COLUMN * place[0], 20 + _ROW * place[1]


def _arrow(source: tuple[int, float], target: tuple[int, float]) -> str:
    (x0, y0), (x1, y1) = _centre(source), _centre(target)
    x0, x1 = x0 + _WIDTH / 2, x1 - _WIDTH / 2
    bend = (x1 - x0) / 2
    return (f'<path d="M{x0:.0f} {y0:.0f}C{x0 + bend:.0f} {y0:.0f} {x1 - bend:.0f} {y1:.0f} '
            f'{x1:.0f} {y1:.0f}" fill="none" stroke="#777" stroke-width="0.8" '
            'marker-end="url(#tip)"/>')  # fmt: skip


def _box(graph: Graph, key: str, place: tuple[int, float]) -> str:
    step = graph.steps[key]
    x, y = _centre(place)
    outline, kind = OUTLINES[step.kind]
    label = f"({key})" if step.number is not None else "•"
    return (
        f"<g><title>{escape(f'{step.label} {kind}: {step.operation}')}</title>"
        f'<rect x="{x - _WIDTH / 2:.0f}" y="{y - _HEIGHT / 2:.0f}" width="{_WIDTH}" '
        f'height="{_HEIGHT}" rx="4" fill="white" {outline}/>'
        f'<text x="{x:.0f}" y="{y + 4:.0f}" text-anchor="middle">{label}</text></g>'
    )


def _legend(height: float) -> list[str]:
    parts = []
    for place, (outline, name) in enumerate(OUTLINES.values()):
        x = 20 + 110 * place
        parts.append(f'<rect x="{x}" y="{height - 24:.0f}" width="18" height="12" rx="2" '
                     f'fill="white" {outline}/>'
                     f'<text x="{x + 24}" y="{height - 14:.0f}">{name}</text>')  # fmt: skip
    parts.append(f'<text x="{20 + 110 * len(OUTLINES)}" y="{height - 14:.0f}">'
                 "• an assumption or definition without a number</text>")  # fmt: skip
    return parts
