"""Coupling between sites: sparse weights, given by name, by a matrix, a graph or a file.

With weights W_nj the force on site n is c Σ_j W_nj (y_j - y_n): row n contains the weights with
which other sites act on site n, and equal displacements cause no force. A weight W_nn on the
diagonal is a spring to a wall, -c W_nn y_n. Fixed ends are such springs.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import sparse

from theory.arrays import FloatArray
from theory.chains.ends import Ends
from theory.parameters import MissingPackageError, ParameterError, random_seed

IntArray = npt.NDArray[np.int32]

Steps = dict[tuple[int, ...], float]
"""Weights by the step from a site to a coupled one, in rows and columns."""

FILES = (".npz", ".mtx", ".mtx.gz")


@dataclass(frozen=True, kw_only=True, eq=False)
class Network:
    """Weights of a coupling in compressed rows, without the diagonal; made by `network_of`.

    Attributes
    ----------
    starts : int array, shape (N + 1,)
        Index at which each row begins.
    sites : int array, shape (M,)
        Column indices, ascending within a row.
    weights : float array, shape (M,)
        W_nj, n ≠ j.
    total : float array, shape (N,)
        Σ_j W_nj of each row, the wall included: the force is c (Σ_j W_nj y_j - total_n y_n).
    positions : float array, shape (N, D), or None
        Positions of the sites, in units of the distance between neighbours; None for a network
        that is not a lattice.
    """

    starts: IntArray
    sites: IntArray
    weights: FloatArray
    total: FloatArray
    positions: FloatArray | None

    @cached_property
    def reach(self) -> int:
        """Largest distance in index between coupled sites."""
        rows = np.repeat(np.arange(self.total.size), np.diff(self.starts))
        return int(np.abs(rows - self.sites).max(initial=0))

    @cached_property
    def matrix(self) -> Any:
        """The matrix L of the force -cLy, as a sparse matrix."""
        links = sparse.csr_array(
            (self.weights, self.sites, self.starts), shape=(self.total.size,) * 2
        )
        return (sparse.diags_array(self.total) - links).tocsr()

    def packed(self) -> FloatArray:
        """Return total, weights, starts and sites in one array of floats.

        The last two are int32 values stored in the bytes of floats, since compiled steps take one
        array of floats in addition to the state.
        """
        whole = [_as_floats(each) for each in (self.starts, self.sites)]
        return np.concatenate([self.total, self.weights, *whole])

    @cached_property
    def digest(self) -> str:
        """A digest that identifies the weights."""
        content = hashlib.sha256()
        for part in (self.starts, self.sites, self.weights, self.total):
            content.update(np.ascontiguousarray(part).tobytes())
        return content.hexdigest()[:16]

    def distances(self, sources: Sequence[int]) -> FloatArray:
        """Return, for each site, the number of links from the nearest of the ``sources``.

        Sources are counted from 0; the number is infinite for sites without a path.

        Examples
        --------
        >>> network_of("chain", (5,), Ends.FREE).distances([1]).tolist()
        [1.0, 0.0, 1.0, 2.0, 3.0]
        """
        links = sparse.csr_array(
            (np.ones(self.weights.size), self.sites, self.starts), shape=(self.total.size,) * 2
        )
        # A motion spreads from j to n where W_nj is not zero.
        found = sparse.csgraph.dijkstra(
            links.T, unweighted=True, indices=list(sources), min_only=True
        )
        return np.asarray(found, dtype=float)


def _as_floats(integers: IntArray) -> FloatArray:
    """Return the bytes of int32 integers as floats, padded to an even number of integers."""
    even = np.concatenate([integers, np.zeros(integers.size % 2, dtype=np.int32)])
    return even.view(np.float64)


def network_of(coupling: Any, shape: tuple[int, ...], ends: Ends) -> Network:
    """Return the network that a coupling describes.

    Parameters
    ----------
    coupling : str, Path, sparse matrix, array or networkx graph
        ``chain``; ``next-nearest:1,0.2``, weights by distance or, on a lattice of rows and columns,
        those of the four nearest neighbours and of the four diagonal ones; ``ring``;
        ``small-world:4,0.1,7`` (number of neighbours, fraction of the links that is rewired, seed);
        ``square``; ``hexagonal`` (six neighbours); a file in .npz (of scipy) or .mtx; or the
        weights themselves. An edge of a directed graph acts on its head.
    shape : tuple of int
        Number of sites, or of rows and columns.
    ends : Ends
        Ends of a coupling that is given by name.

    Raises
    ------
    ParameterError
        If the coupling is none of these, or has another size.

    Examples
    --------
    >>> network_of("next-nearest:1,0.2", (5,), Ends.FREE).matrix.toarray()[0].tolist()
    [1.2, -1.0, -0.2, 0.0, 0.0]
    """
    if isinstance(coupling, str) and not is_file(coupling):
        return _by_name(coupling, shape, ends)
    if ends is not Ends.FREE:
        raise _ends_refused(ends, "free where the weights are given")
    if is_file(coupling):
        return _of_matrix(_read(Path(coupling)), shape)
    if hasattr(coupling, "adjacency") and hasattr(coupling, "nodes"):
        return _of_matrix(_of_graph(coupling), shape)
    return _of_matrix(coupling, shape)


def is_file(coupling: Any) -> bool:
    """Return whether a coupling is a file: a `Path`, or a text with the ending of such a file."""
    return isinstance(coupling, Path) or (
        isinstance(coupling, str) and coupling.lower().endswith(FILES)
    )


def size_of(coupling: Any) -> int | None:
    """Return the number of sites of a matrix or a graph; None for a coupling given by name."""
    if is_file(coupling):
        coupling = _read(Path(coupling))
    if isinstance(coupling, str):
        return None
    if hasattr(coupling, "adjacency") and hasattr(coupling, "nodes"):
        return int(coupling.number_of_nodes())
    try:
        shape = np.shape(coupling)
    except ValueError:  # rows of different lengths, which `network_of` refuses
        return None
    return int(shape[0]) if len(shape) == 2 else None


def largest_group_slope(coupling: str) -> float:
    """Return max |Σ_d d w_d sin(kd)| over k, for weights w_d by distance along a line.

    The frequency of a phase wave e^{ikn} of (8) with such weights is shifted by
    εc Σ_d w_d (1 - cos kd), so that its group velocity is at most εc times this maximum, which is
    one for nearest neighbours.

    Parameters
    ----------
    coupling : str
        ``chain``, ``ring`` or ``next-nearest``, with or without weights.

    Examples
    --------
    >>> largest_group_slope("chain"), largest_group_slope("chain:0,1")
    (1.0, 2.0)
    """
    weights = np.array(_numbers(coupling) or [1.0])
    d = np.arange(1, weights.size + 1)
    # zeros of the derivative, Σ d² w_d T_d(cos k)
    turns = np.polynomial.chebyshev.chebroots([0.0, *(d**2 * weights)])
    k = np.arccos(np.clip(turns[np.abs(turns.imag) < 1e-6].real, -1.0, 1.0))
    return float(np.abs(np.sin(np.outer(k, d)) @ (d * weights)).max(initial=0.0))


def _refused(coupling: object, allowed: str, remedy: str) -> ParameterError:
    return ParameterError("coupling", coupling, allowed, remedy)


def _ends_refused(ends: Ends, allowed: str) -> ParameterError:
    return ParameterError("ends", ends.value, allowed, "leave them out")


def _by_name(text: str, shape: tuple[int, ...], ends: Ends) -> Network:
    name = text.partition(":")[0]
    if name not in _MAKERS:
        raise _refused(
            repr(text), f"one of {', '.join(_MAKERS)}, or a file ending in {', '.join(FILES)}",
            "name one, as next-nearest:1,0.2",
        )  # fmt: skip
    numbers = _numbers(text)
    most = _MAX_NUMBERS.get(name, len(numbers))
    if len(numbers) > most:
        raise _refused(repr(text), f"followed by no more numbers than {most}", "leave out the rest")
    return _MAKERS[name](text, numbers, shape, ends)


def _numbers(text: str) -> list[float]:
    """Return the numbers that follow a name and a colon."""
    given = text.partition(":")[2]
    try:
        numbers = [float(part) for part in given.split(",")] if given else []
    except ValueError:
        numbers = [math.nan]
    if not all(map(math.isfinite, numbers)):
        raise _refused(repr(text), "followed by finite numbers", "as in next-nearest:1,0.2")
    return numbers


def _chain(text: str, numbers: list[float], shape: tuple[int, ...], ends: Ends) -> Network:
    """Return the network of weights by distance along the chain; by default 1 for neighbours."""
    by_distance = numbers or [1.0]
    if len(shape) != 1:
        raise _refused(
            repr(text), "square, next-nearest or hexagonal for rows and columns", "name one of them"
        )
    farthest = shape[0] // 2 if ends is Ends.PERIODIC else shape[0] - 1
    if len(by_distance) > farthest:
        raise _refused(
            repr(text),
            f"with fewer weights for {shape[0]} sites",
            "take more sites or fewer weights",
        )
    steps: Steps = {(s * d,): w for d, w in enumerate(by_distance, 1) for s in (-1, 1)}
    return _lattice(shape, ends, steps, lambda n: n.astype(float))


def _next_nearest(text: str, numbers: list[float], shape: tuple[int, ...], ends: Ends) -> Network:
    if len(numbers) < 2:
        raise _refused(repr(text), "followed by two weights or more", "as in next-nearest:1,0.2")
    if len(shape) == 2:
        if len(numbers) > 2:
            raise _refused(repr(text), "followed by two weights on a lattice", "leave out the rest")
        return _square(text, numbers, shape, ends)
    return _chain(text, numbers, shape, ends)


def _ring(text: str, numbers: list[float], shape: tuple[int, ...], ends: Ends) -> Network:
    return _chain(text, numbers, shape, Ends.PERIODIC)


def _square(text: str, numbers: list[float], shape: tuple[int, ...], ends: Ends) -> Network:
    """Return a square lattice with one weight for nearest and a second for diagonal neighbours."""
    straight, diagonal = [*numbers, *[1.0, 0.0][len(numbers) :]]
    steps: Steps = dict.fromkeys(((0, 1), (0, -1), (1, 0), (-1, 0)), straight)
    steps |= dict.fromkeys(((1, 1), (1, -1), (-1, 1), (-1, -1)), diagonal)
    return _lattice(_two(text, shape), ends, steps, lambda n: n[:, ::-1].astype(float))


def _hexagonal(text: str, numbers: list[float], shape: tuple[int, ...], ends: Ends) -> Network:
    """Return a lattice with six neighbours at distance 1, each row shifted by half a distance."""
    weight = numbers[0] if numbers else 1.0
    steps: Steps = dict.fromkeys(((0, 1), (0, -1), (1, 0), (-1, 0), (1, -1), (-1, 1)), weight)

    def places(n: npt.NDArray[np.int64]) -> FloatArray:
        return np.stack([n[:, 1] + 0.5 * n[:, 0], 0.5 * math.sqrt(3.0) * n[:, 0]], axis=1)

    return _lattice(_two(text, shape), ends, steps, places)


def _two(text: str, shape: tuple[int, ...]) -> tuple[int, ...]:
    if len(shape) != 2:
        raise _refused(
            repr(text),
            "a coupling for a single row of sites",
            "give sites as rows x columns, as 60x60",
        )
    return shape


def _small_world(text: str, numbers: list[float], shape: tuple[int, ...], ends: Ends) -> Network:
    """Return a ring with k neighbours, a fraction of its links rewired (Watts & Strogatz, 1998)."""
    k, part, seed = [*numbers, *[4.0, 0.1, 0.0][len(numbers) :]]
    (count,) = shape if len(shape) == 1 else (0,)
    fits = k == int(k) and k % 2 == 0 and 2 <= k < count and 0.0 <= part <= 1.0
    if not fits:
        raise _refused(
            repr(text), "an even number of neighbours below that of sites, a fraction from 0 to 1, "
            "a seed", "as in small-world:4,0.1,7",
        )  # fmt: skip
    if ends is Ends.FIXED:
        raise _ends_refused(ends, "free or periodic for a ring that is rewired")
    random = np.random.default_rng(random_seed(seed))
    links = [
        {(n + d) % count for d in range(-int(k) // 2, int(k) // 2 + 1) if d} for n in range(count)
    ]
    for d in range(1, int(k) // 2 + 1):
        for n in range(count):
            old = (n + d) % count
            if random.random() >= part or old not in links[n] or len(links[n]) >= count - 1:
                continue
            new = n
            while new == n or new in links[n]:
                new = int(random.integers(count))
            links[n].remove(old)
            links[old].remove(n)
            links[n].add(new)
            links[new].add(n)
    rows = np.repeat(np.arange(count), [len(each) for each in links])
    columns = np.concatenate([sorted(each) for each in links]).astype(int)
    return _of_matrix(
        sparse.csr_array((np.ones(rows.size), (rows, columns)), shape=(count, count)), shape
    )


_MAKERS: Mapping[str, Callable[[str, list[float], tuple[int, ...], Ends], Network]] = {
    "chain": _chain,
    "ring": _ring,
    "next-nearest": _next_nearest,
    "small-world": _small_world,
    "square": _square,
    "hexagonal": _hexagonal,
}

_MAX_NUMBERS = {"small-world": 3, "square": 2, "hexagonal": 1}
"""Largest number of numbers after a name; there is no entry where it depends on the sites."""


def _lattice(
    shape: tuple[int, ...],
    ends: Ends,
    steps: Steps,
    places: Callable[[npt.NDArray[np.int64]], FloatArray],
) -> Network:
    """Return the network in which every site is coupled to those at the given steps from it."""
    if not any(steps.values()):
        raise _refused("weights that are all zero", "one that couples sites", "give c = 0 instead")
    count = math.prod(shape)
    index = np.stack(np.unravel_index(np.arange(count), shape), axis=1)
    rows, columns, weights = [], [], []
    wall = np.zeros(count)
    limits = np.array(shape)
    for step, weight in steps.items():
        if weight == 0.0:
            continue
        there = index + np.array(step)
        inside = np.all((there >= 0) & (there < limits), axis=1)
        if ends is Ends.PERIODIC:
            there %= limits
            inside[:] = True
        elif ends is Ends.FIXED:
            wall[~inside] += weight
        at = np.ravel_multi_index(tuple(there[inside].T), shape)
        rows.append(np.flatnonzero(inside))
        columns.append(at)
        weights.append(np.full(at.size, weight))
    links = sparse.csr_array(
        (np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))),
        shape=(count, count),
    )
    return _built(links, wall, places(index))


def _built(links: Any, wall: FloatArray, positions: FloatArray | None) -> Network:
    links.sum_duplicates()
    links.sort_indices()
    total = np.asarray(links.sum(axis=1), dtype=float).ravel() + wall
    return Network(
        starts=links.indptr.astype(np.int32),
        sites=links.indices.astype(np.int32),
        weights=links.data.astype(float),
        total=total,
        positions=positions,
    )


def _of_matrix(given: Any, shape: tuple[int, ...]) -> Network:
    count = math.prod(shape)
    try:
        if np.ma.is_masked(given) or np.iscomplexobj(given):
            raise _refused(
                "a matrix with masked or complex numbers", "one of real numbers", "replace them"
            )
        matrix = sparse.csr_array(given, dtype=float)
    except ParameterError:
        raise
    except (TypeError, ValueError):
        raise _refused(
            f"an object of type {type(given).__name__}", "a name, a file, a matrix or a graph",
            "give for example a sparse matrix of scipy",
        ) from None  # fmt: skip
    if matrix.shape != (count, count):
        raise _refused(
            f"a matrix of shape {matrix.shape}", f"of shape ({count}, {count}), a row per site",
            "give such a matrix, or omit the number of sites",
        )  # fmt: skip
    if not np.all(np.isfinite(matrix.data)):
        raise _refused("a matrix with NaN or infinity in it", "finite", "correct its entries")
    wall = matrix.diagonal()
    every = matrix.tocoo()
    apart = every.row != every.col
    links = sparse.csr_array(
        (every.data[apart], (every.row[apart], every.col[apart])), shape=matrix.shape
    )
    links.eliminate_zeros()
    if not links.nnz:
        raise _refused("a matrix without links", "one that couples sites", "give c = 0 instead")
    return _built(links, wall, None)


def _of_graph(graph: Any) -> Any:
    try:
        import networkx
    except ModuleNotFoundError:
        raise MissingPackageError("networkx", "networks", "a coupling from a graph") from None
    return sparse.csr_array(networkx.to_scipy_sparse_array(graph)).T.tocsr()


def _read(path: Path) -> Any:
    """Return the matrix stored in a file."""
    from scipy.io import mmread

    try:
        if path.suffix.lower() == ".npz":
            return sparse.csr_array(sparse.load_npz(path))
        return sparse.csr_array(mmread(path))
    except (OSError, ValueError, KeyError, TypeError) as error:
        why = " ".join(str(getattr(error, "strerror", None) or error).split())[:80]
        raise _refused(
            str(path), f"a sparse matrix of scipy (.npz) or of Matrix Market (.mtx): {why}",
            "write it by scipy.sparse.save_npz or scipy.io.mmwrite",
        ) from None  # fmt: skip
