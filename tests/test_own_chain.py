"""Chains of one's own: the paper's chain as text is the built-in one, and others are scipy's."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy import sparse
from scipy.integrate import solve_ivp
from scipy.io import mmwrite
from scipy.spatial.distance import cdist

from derivations.cell.polynomial_text import read_polynomial as read_for_derivations
from tests.reference_runs import overdamped_rate, states_by_scipy
from theory.arrays import FloatArray
from theory.cells.oscillator import OscillatorCell
from theory.cells.polynomial import read_polynomial
from theory.chains.chain import SmoothChain
from theory.chains.coupling import network_of
from theory.chains.ends import Ends
from theory.chains.oscillator import AveragedOscillatorChain, OscillatorChain
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError
from verification.references.equations import pull_matrix
from verification.references.network import oscillator_rate
from verification.runs.excite import excite
from verification.runs.simulate import simulate
from verification.runs.trajectory import RunStatus
from verification.steppers import kernel

PAPER = "1 - a*y**2 + b*y**4"
VALUES = {"a": 4.0, "b": 0.5}


def papers(**changes: Any) -> OscillatorChain:
    return OscillatorChain(**{"damping": PAPER, "values": VALUES, "c": 0.6, **changes})


# The equation, its text and its coupling


@pytest.mark.parametrize(
    "text",
    [
        PAPER,
        "(1 - y)^2*k/4",
        "y*(y - 1)*(a - y)",
        "-3",
        "1 - 1e-5*y**2 + 2.5E+2*y**4/1e3",
        "2*(y + w)**3 - w*(1 - y/7)",
        "-y**(2) + 3*--y",
    ],
)
def test_both_readers_of_polynomials_find_the_same_terms(text: str) -> None:
    assert read_polynomial(text).terms == read_for_derivations(text)


@pytest.mark.parametrize("text", ["True*y**2", "1 - False*y", "1 + None", "y**True", "1/True"])
@pytest.mark.parametrize("read", [read_polynomial, read_for_derivations])
def test_words_of_python_are_no_numbers_and_are_not_called_numbers(read: Any, text: str) -> None:
    with pytest.raises(ValueError, match=r"not allowed in one|must be a whole number") as refused:
        read(text)
    assert "the number" not in str(refused.value)


@pytest.mark.parametrize("variable", ["y", "v"])
def test_generated_code_is_the_polynomial_and_its_derivative(variable: str) -> None:
    text = "a*y**3*v**2 - (a + 1)*v + 2*b*y**5*v**3 - 7*y/3 + b"
    values = {"a": 1.7, "b": -0.3, "y": 0.9, "v": 1.3}
    exact = sp.sympify(text)
    polynomial = read_polynomial(text)
    for ours, theirs in (
        (polynomial, exact),
        (polynomial.derivative(variable), exact.diff(variable)),
        (polynomial.times(variable), exact * sp.Symbol(variable)),
    ):
        assert eval(ours.source(), dict(values)) == pytest.approx(float(theirs.subs(values)))


def test_an_expression_of_sympy_is_its_text() -> None:
    y, a = sp.symbols("y a")
    assert papers(damping=1 - a * y**2 + y**4 / 2, values={"a": 4}).parameters()["values"] == {
        "a": 4.0
    }


def test_the_chain_of_the_paper_as_text_is_the_built_in_one() -> None:
    """Its compiled arithmetic is the same; by rows of a matrix only sums are in another order."""
    start = excite(VdpChain(**VALUES, c=0.6, sites=15), [7, 8])
    built_in = simulate(VdpChain(**VALUES, c=0.6, sites=15), start, 300.0, samples=7)
    text = simulate(papers(sites=15), start, 300.0, samples=7)
    rows = simulate(papers(coupling=np.eye(15, k=1) + np.eye(15, k=-1)), start, 300.0, samples=7)
    assert np.array_equal(text.states, built_in.states)
    assert np.array_equal(text.arrivals, built_in.arrivals, equal_nan=True)
    assert np.abs(rows.states - built_in.states).max() < 1e-11
    np.testing.assert_allclose(rows.arrivals, built_in.arrivals, rtol=1e-11)


def test_weights_in_nested_lists_are_those_of_the_matrix() -> None:
    weights = np.eye(5, k=1) + 0.3 * np.eye(5, k=-1)
    assert papers(coupling=weights.tolist()) == papers(coupling=weights)


def hexagonal_matrix(rows: int, columns: int) -> FloatArray:
    """Neighbours are the sites at distance 1: rows are shifted by half a distance each."""
    places = np.array(
        [[j + 0.5 * i, math.sqrt(0.75) * i] for i in range(rows) for j in range(columns)]
    )
    near = (np.abs(cdist(places, places) - 1.0) < 1e-9).astype(float)
    return np.diag(near.sum(axis=1)) - near


def lattice_matrix(rows: int, columns: int, ends: Ends) -> FloatArray:
    along, across = pull_matrix(columns, ends), pull_matrix(rows, ends)
    return np.kron(np.eye(rows), along) + np.kron(across, np.eye(columns))


def far_matrix(sites: int, weight: float) -> FloatArray:
    """Nearest neighbours, and second ones with a weight; free ends."""
    found = pull_matrix(sites)
    for n in range(sites - 2):
        found[[n, n + 2], [n, n + 2]] += weight
        found[[n, n + 2], [n + 2, n]] -= weight
    return found


def test_couplings_by_name_are_what_they_say() -> None:
    free, fixed = Ends.FREE, Ends.FIXED
    for name, shape, ends, expected in (
        ("next-nearest:1,0.2", (9,), free, far_matrix(9, 0.2)),
        ("ring", (9,), free, pull_matrix(9, Ends.PERIODIC)),
        ("chain", (9,), fixed, pull_matrix(9, Ends.LITERAL)),
        ("square", (4, 5), free, lattice_matrix(4, 5, free)),
        ("square", (4, 5), fixed, lattice_matrix(4, 5, Ends.LITERAL)),
        ("square", (4, 5), Ends.PERIODIC, lattice_matrix(4, 5, Ends.PERIODIC)),
        ("hexagonal", (4, 5), free, hexagonal_matrix(4, 5)),
    ):
        found = network_of(name, shape, ends).matrix.toarray()
        np.testing.assert_allclose(found, expected, atol=1e-14, err_msg=name)
    rows, columns = np.divmod(np.arange(20), 5)
    apart = np.hypot(np.subtract.outer(rows, rows), np.subtract.outer(columns, columns))
    pulls = -1.0 * (apart == 1.0) - 0.2 * (np.abs(apart - np.sqrt(2.0)) < 1e-12)
    found = network_of("next-nearest:1,0.2", (4, 5), free).matrix.toarray()
    np.testing.assert_allclose(found, pulls - np.diag(pulls.sum(axis=1)), atol=1e-14)
    small = network_of("small-world:4,0.3,1", (40,), free)
    matrix = small.matrix.toarray()
    assert np.array_equal(matrix, matrix.T)
    assert np.trace(matrix) == 160.0  # links are moved, none is lost
    assert small.digest == network_of("small-world:4,0.3,1", (40,), free).digest
    assert small.digest != network_of("small-world:4,0.3,2", (40,), free).digest
    ring = network_of("next-nearest:1,1", (40,), Ends.PERIODIC).matrix.toarray()
    moved = np.count_nonzero(np.triu(matrix - ring) > 0)
    assert 10 <= moved <= 40  # of 80, three in ten


def test_matrices_files_and_graphs_are_couplings(tmp_path: Path) -> None:
    weights = sparse.csr_array([[0.0, 2.0, 0.0], [1.0, 0.0, 0.0], [0.0, 3.0, 0.5]])
    expected = [[2.0, -2.0, 0.0], [-1.0, 1.0, 0.0], [0.0, -3.0, 3.5]]  # W_33 is a wall
    sparse.save_npz(tmp_path / "w.npz", weights.tocoo())
    mmwrite(tmp_path / "w.mtx", weights)
    for given in (weights, weights.toarray(), tmp_path / "w.npz", str(tmp_path / "w.mtx")):
        chain = papers(coupling=given)
        assert chain.sites == 3
        assert chain.links.matrix.toarray().tolist() == expected


def test_an_edge_of_a_graph_acts_on_its_head() -> None:
    networkx = pytest.importorskip("networkx")
    graph = networkx.DiGraph()
    graph.add_nodes_from(range(3))
    graph.add_edge(0, 1, weight=2.0)
    assert papers(coupling=graph).links.matrix.toarray()[1].tolist() == [-2.0, 2.0, 0.0]


# Runs against scipy, the equation written a second time

# One text for both, so that it is compiled once.
GENERAL = "p6*y**6 - p4*y**4 + p2*y**2 + q*v**2 - m"
RAYLEIGH = {
    "damping": GENERAL, "values": {"m": 1.0, "p2": 0, "p4": 0, "p6": 0, "q": 1},
    "disorder": {"m": 0.2}, "seed": 3,
}  # fmt: skip


def three(rows: int, columns: int, **changes: Any) -> OscillatorChain:
    """Return a lattice of cells with three cycles."""
    values = {"m": np.ones(rows * columns), "p2": 1, "p4": 0.144, "p6": 0.005, "q": 0}
    return OscillatorChain(
        damping=GENERAL, values=values, c=0.05, eps=0.1, coupling="square", sites=(rows, columns),
        **changes,
    )  # fmt: skip


@pytest.mark.parametrize("kind", [OscillatorChain, AveragedOscillatorChain])
def test_a_ring_by_name_is_run_as_the_ring_that_its_matrix_is(kind: type[OscillatorChain]) -> None:
    """Sites 1 and 2 excited: on a ring of 12 sites 12 and 3 are alike, on an open chain not."""
    matrix = np.roll(np.eye(12), 1, axis=1) + np.roll(np.eye(12), -1, axis=1)
    cell: Any = {"damping": PAPER, "values": VALUES, "c": 0.6, "sites": 12}
    named, given = (kind(**cell, coupling=each) for each in ("ring", matrix))
    runs = [simulate(each, excite(each, [1, 2]), 100.0, tolerance=1e-10) for each in (named, given)]
    last = [run.states[-1] for run in runs]
    assert np.abs(last[1]).max() > 0.5
    assert np.abs(last[0] - last[1]).max() <= runs[0].error + runs[1].error < 1e-4
    assert named == kind(**cell, ends="periodic")
    with pytest.raises(ParameterError, match="ends = fixed is not allowed"):
        kind(**cell, coupling="ring", ends="fixed")


def kinds() -> dict[str, tuple[OscillatorChain, Any, list[int]]]:
    """Return chains, their rates for scipy, and the sites excited."""
    duffing = OscillatorChain(
        damping="1 - 4*y**2 + y**4/2", stiffness="y + k*y**3", values={"k": 0.3}, c=2.0, eps=0.05,
        velocity_coupling=0.3, coupling="next-nearest:1,0.2", sites=12,
    )  # fmt: skip
    rayleigh = OscillatorChain(**RAYLEIGH, c=1.0, eps=0.1, coupling="ring", sites=10)
    nagumo = OscillatorChain(
        damping=0, stiffness="y*(1 - y)*(alpha - y)", values={"alpha": 0.2}, c=0.4, overdamped=True,
        coupling="hexagonal", sites=(4, 5),
    )  # fmt: skip
    m = 1.0 + 0.2 * np.random.default_rng([3, 0]).standard_normal(10)
    return {
        "next-nearest Duffing-Van der Pol": (
            duffing,
            oscillator_rate(
                lambda y: y + 0.3 * y**3, lambda y, v: 1.0 - 4.0 * y**2 + 0.5 * y**4,
                far_matrix(12, 0.2), c=2.0, eps=0.05, d=0.3,
            ),
            [5, 6],
        ),
        "disordered ring of Rayleigh": (
            rayleigh,
            oscillator_rate(
                lambda y: y, lambda y, v: v**2 - m, pull_matrix(10, Ends.PERIODIC), c=1.0, eps=0.1
            ),
            [1, 4],
        ),
        "three cycles on a square lattice": (
            three(4, 5, ends="fixed"),
            oscillator_rate(
                lambda y: y, lambda y, v: 0.005 * y**6 - 0.144 * y**4 + y**2 - 1.0,
                lattice_matrix(4, 5, Ends.LITERAL), c=0.05, eps=0.1,
            ),
            [8],
        ),
        "overdamped hexagonal": (
            nagumo,
            overdamped_rate(
                lambda y: y * (1.0 - y) * (0.2 - y), hexagonal_matrix(4, 5), c=0.4
            ),
            [1, 2, 6],
        ),
    }  # fmt: skip


@pytest.mark.parametrize("name", list(kinds()))
def test_the_error_of_a_run_bounds_its_distance_from_scipy(name: str) -> None:
    chain, rate, excited = kinds()[name]
    start = excite(chain, excited)
    run = simulate(chain, start, 30.0, samples=4, tolerance=1e-8)
    assert run.status is RunStatus.RESOLVED
    flat = start.ravel() if chain.oscillates else start[0]
    exact = states_by_scipy(rate, flat, run.times)
    ours = run.states.reshape(4, -1) if chain.oscillates else run.y
    assert 1e-12 < np.abs(ours - exact).max() <= run.error < 1e-4


@pytest.mark.parametrize("on_velocities", [0, 1])
@pytest.mark.parametrize(("begin", "end"), [(0, 5), (1, 4), (0, 3), (2, 5)])
def test_the_slope_of_a_network_is_the_kernel_at_every_site(
    begin: int, end: int, on_velocities: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of those from begin to end; the others are at rest."""

    def packed(numbers: Any) -> FloatArray:
        return np.append(numbers, [0] * (len(numbers) % 2)).astype(np.uint32).view(float)

    def of_site(site: Any, pull: Any, p: Any, n: int, sites: int) -> Any:
        return site[1] + pull[0] + n, pull[1] - p[0] * site[0] + sites

    monkeypatch.setattr(kernel, "inner", lambda **_: lambda function: function)
    rng = np.random.default_rng(8)
    matrix = rng.normal(size=(5, 5)) * (1.0 - np.eye(5)) * (rng.random((5, 5)) < 0.7)
    total, (rows, others) = rng.normal(size=5), np.nonzero(matrix)
    p = np.concatenate([
        [0.5, 0.0, 0.0, rows.size, 0.0], rng.normal(size=5), total, matrix[rows, others],
        packed(np.searchsorted(rows, np.arange(6))), packed(others),
    ])  # fmt: skip
    layout = (5, 1, on_velocities)  # scalars, numbers of each site, whether velocities are coupled
    slope: Any = kernel.network_slope.__wrapped__(of_site, "", *layout)
    y, w = np.zeros((2, 5))
    y[begin:end], w[begin:end] = rng.normal(size=(2, end - begin))
    found = np.empty(2 * (end - begin))
    slope.py_func(np.append(y[begin:end], w[begin:end]), p, begin, 5, found)
    pull_y, pull_w = total * y - matrix @ y, on_velocities * (total * w - matrix @ w)
    expected = np.array([w + pull_y + np.arange(5), pull_w - 0.5 * y + 5.0])
    assert found == pytest.approx(expected[:, begin:end].ravel(), abs=1e-12)


def test_the_active_window_of_a_lattice_changes_nothing() -> None:
    chain = three(40, 5)
    start = excite(chain, [98], 4.5)
    whole = simulate(chain, start, 40.0, samples=3, active_window=False, estimate_error=False)
    part = simulate(chain, start, 40.0, samples=3, estimate_error=False)
    assert part.mean_active < 0.95 * whole.mean_active
    assert np.abs(part.states - whole.states).max() < 1e-8


# Cycles of one cell


def test_a_cycle_of_the_general_quadrature_is_that_of_the_polynomial() -> None:
    damping = {(0, 0): 1.0, (2, 0): -4.0, (4, 0): 0.5, (0, 2): 0.1}
    plain = OscillatorCell(stiffness={1: 1.0}, damping=damping)
    bent = OscillatorCell(stiffness={1: 1.0, 3: 1e-13}, damping=damping)
    assert not bent.harmonic
    for one, other in zip(plain.cycles, bent.cycles, strict=True):
        assert other.stable == one.stable
        assert other[:3] == pytest.approx(one[:3], rel=1e-9)


def test_the_cycle_of_a_stiff_cell_is_where_scipy_ends() -> None:
    """Stiffness that is neither linear nor odd, ε = 1e-3: the cycle to O(ε), and its period."""
    cell = OscillatorCell(stiffness={1: 1.0, 2: 0.3, 3: 0.2}, damping={(0, 0): -1.0, (2, 0): 1.0})
    (cycle,) = cell.cycles
    eps = 1e-3
    rate = oscillator_rate(
        lambda y: y + 0.3 * y**2 + 0.2 * y**3, lambda y, v: y**2 - 1.0, np.zeros((1, 1)), c=0.0,
        eps=eps,
    )  # fmt: skip
    start = np.array([cycle.amplitude, 0.0])
    after = states_by_scipy(rate, start, np.array([0.0, cycle.period]))[-1]
    assert abs(after[0] - cycle.amplitude) < 10.0 * eps**2
    far = start * [1.01, 1.0]
    drawn = states_by_scipy(rate, far, np.array([0.0, cycle.period]))[-1]
    assert drawn[0] < far[0] - 1e-5  # stable: what begins outside is drawn inwards


def test_every_site_of_a_short_chain_may_be_coupled_to_every_other() -> None:
    row = network_of("next-nearest:1,0.2", (3,), Ends.FREE).matrix.toarray()[0]
    assert row.tolist() == [1.2, -1.0, -0.2]
    for ends, sites in ((Ends.FREE, 2), (Ends.PERIODIC, 3)):
        with pytest.raises(ParameterError, match=f"fewer weights for {sites} sites"):
            network_of("next-nearest:1,0.2", (sites,), ends)


# What is refused, in one sentence

NO_INERTIA = {
    "overdamped": True, "damping": 0, "stiffness": "y*(1 - y)*(a - y)", "values": {"a": 0.2}
}  # fmt: skip

BAD: list[tuple[dict[str, Any], str]] = [
    ({"damping": "sin(y)"}, r"damping = 'sin\(y\)' is not allowed"),
    ({"damping": "1/y"}, "it may be divided only by a number other than zero"),
    ({"damping": "y**0.5"}, "is not allowed in one"),
    ({"damping": "__import__('os').system('x')"}, "is not allowed in one"),
    ({"damping": "(y + 1"}, "it cannot be read"),
    ({"damping": None}, "damping = NoneType is not allowed"),
    ({"stiffness": "y + v"}, "put v into the damping"),
    ({"stiffness": "y + 1"}, "y = 0 is a state of rest"),
    ({"stiffness": "y**3 - y"}, "minimum of the potential"),
    ({"stiffness": "y - y**3"}, "motion stays bounded"),
    ({"stiffness": "y + y**2"}, "motion stays bounded"),
    ({"damping": "1 - a*y**2 - b*y**4"}, "motion stays bounded"),
    ({"stiffness": "y + y**3", "damping": "1 - a*y**2 - b*v**2"}, "motion stays bounded"),
    ({"disorder": {"b": "uniform:1"}, "values": {"a": 4, "b": -0.1}}, "motion stays bounded"),
    ({"values": {"a": 4}}, "complete: b missing"),
    ({"values": "a="}, "values = 'a=' .* be a name and a number; write them as a=4"),
    ({"values": 4}, "values = 4 .* be a mapping, or texts; write them as a=4"),
    ({"values": ["a=x", "b=1"]}, "a = 'x' .* be a number; give one, as a=4"),
    ({"values": {**VALUES, "q": 1}}, "named parameter = q"),
    ({"values": {"a": float("nan"), "b": 1}}, "a = nan"),
    ({"values": {"a": np.ones(7), "b": 1}}, r"a = an array of shape \(7,\)"),
    ({"values": ["a=4", "b"]}, "a name and a number"),
    ({"damping": "y**2 - c", "values": {"c": 1}}, "named parameter = c"),
    ({"disorder": {"a": 2.0}}, "disorder of a"),
    ({"disorder": {"z": 0.1}}, "disorder = z .* that of one of a, b"),
    ({"coupling": "star"}, "coupling = 'star'"),
    ({"coupling": "next-nearest"}, "two weights or more"),
    ({"coupling": "next-nearest:1,nan"}, "finite numbers"),
    ({"coupling": "next-nearest:1,0.2,0.1", "sites": (5, 6)}, "two weights on a lattice"),
    ({"coupling": "square"}, "rows x columns"),
    ({"coupling": "chain", "sites": (5, 6)}, "square, next-nearest or hexagonal"),
    ({"coupling": "small-world:3,0.1"}, "even number of neighbours"),
    ({"coupling": "small-world:4,0.1,0.5", "sites": 9}, "seed = 0.5 is not allowed"),
    ({"coupling": "small-world:4,0.1,7,9", "sites": 9}, "no more numbers than 3"),
    ({"coupling": "square:1,0.2,0.3", "sites": (5, 6)}, "no more numbers than 2"),
    ({"coupling": "hexagonal:1,2", "sites": (5, 6)}, "no more numbers than 1"),
    ({"coupling": "chain:0"}, "weights that are all zero"),
    ({"coupling": "square:0,0", "sites": (5, 6)}, "weights that are all zero"),
    ({"seed": -1}, "seed = -1 is not allowed"),
    ({"coupling": np.ones((3, 4))}, r"a matrix of shape \(3, 4\)"),
    ({"coupling": np.ones((3, 3)), "sites": 4}, r"of shape \(4, 4\)"),
    ({"coupling": np.full((3, 3), np.nan)}, "NaN or infinity"),
    ({"coupling": np.eye(3)}, "without links"),
    ({"coupling": np.ones((3, 3)) * 1j}, "masked or complex numbers"),
    ({"coupling": sparse.csr_array(np.ones((3, 3)) * 1j)}, "masked or complex numbers"),
    ({"coupling": np.ma.masked_equal(np.eye(3, k=1), 1.0)}, "masked or complex numbers"),
    ({"coupling": [[1.0], [1.0, 2.0]]}, "an object of type list"),
    ({"coupling": np.ones((3, 3)), "ends": "periodic"}, "ends = periodic .* weights are given"),
    ({"coupling": "small-world:4,0.1,7", "ends": "fixed"}, "ends = fixed .* a ring"),
    ({"coupling": "nowhere.npz"}, "a sparse matrix of scipy"),
    ({"coupling": object()}, "an object of type object"),
    ({"overdamped": True}, "damping = .* 0 without inertia"),
    ({**NO_INERTIA, "velocity_coupling": 0.5}, "velocity coupling = 0.5 .* 0 without inertia"),
    ({**NO_INERTIA, "eps": 0.5}, "small parameter eps = 0.5 .* 1 without inertia"),
    ({"ends": "literal"}, "free or periodic or fixed"),
]


@pytest.mark.parametrize(("changes", "words"), BAD)
def test_what_is_wrong_is_refused_in_one_sentence(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(ParameterError, match=words) as refusal:
        papers(**changes)
    assert str(refusal.value).count("\n") == 0
    assert len(str(refusal.value)) < 400


def test_a_cell_without_a_cycle_runs_with_a_level_and_is_refused_without() -> None:
    damped = papers(values={"a": 1.0, "b": 0.5})  # η above 1/8
    with pytest.raises(ParameterError, match="without a stable cycle"):
        excite(damped, [3])
    run = simulate(damped, excite(damped, [3], 1.0), 5.0, samples=2, level=0.5)
    assert run.error is not None


# The command line and model files


def test_a_model_file_says_all_and_is_stored_with_the_result(tmp_path: Path, answered: Any) -> None:
    sparse.save_npz(tmp_path / "w.npz", sparse.coo_array(np.eye(9, k=1) + np.eye(9, k=-1)))
    model = tmp_path / "mine.toml"
    model.write_text(
        f'damping = "{PAPER}"\nc = 0.6\ncoupling = "w.npz"\nseed = 2\n'
        "[values]\na = 4\nb = 0.5\n[disorder]\na = 0.01\n"
    )
    out = tmp_path / "run.json"
    line = ["simulate", "chain", "--model", str(model), "--t-end", "20", "--value", "a=4.5"]
    printed = answered([*line, "--out", str(out)])
    assert len(printed["amplitudes"]) == 9
    stored = json.loads(out.read_text())["provenance"]["parameters"]
    assert (stored["damping"], stored["values"]) == (PAPER, {"a": 4.5, "b": 0.5})
    assert stored["disorder"] == {"a": 0.01}
    assert stored["coupling"].startswith("w.npz ")
    chain = OscillatorChain.from_file(model)
    run = simulate(chain.replace(a=4.5), excite(chain.replace(a=4.5), [5]), 20.0, samples=2)
    assert run.amplitude[-1].tolist() == printed["amplitudes"]


def test_sites_that_are_given_replace_the_lattice_of_a_model_file(tmp_path: Path) -> None:
    model = tmp_path / "mine.toml"
    model.write_text(
        'damping = "y**2 - 1"\nc = 1\ncoupling = "next-nearest:1,0.2"\nshape = [4, 4]\n'
    )
    assert OscillatorChain.from_file(model).shape == (4, 4)
    chain = OscillatorChain.from_file(model, sites=31)
    assert (chain.sites, chain.shape) == (31, None)


@pytest.mark.parametrize("sites", ["²x5", "٣x5", "6x", "3x3x3", "1_0x5"])
def test_rows_and_columns_of_a_model_file_are_whole_numbers(tmp_path: Path, sites: str) -> None:
    model = tmp_path / "mine.toml"
    model.write_text(f'damping = "y**2 - 1"\nc = 1\nsites = "{sites}"\n', encoding="utf-8")
    with pytest.raises(ParameterError, match="rows x columns"):
        OscillatorChain.from_file(model)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("--damping y**2-1", "give --c"),
        ("--damping y**2-1 --c 1 --n 6xq", "rows x columns"),
        ("--damping y**2-1 --c 1 --value m", "a name and a number"),
        ("--model nowhere.toml", "a readable file in the format TOML"),
        ("--damping exp(y) --c 1", "damping = 'exp(y)'"),
    ],
)
def test_the_command_line_refuses_in_one_sentence(line: str, words: str, refused: Any) -> None:
    assert words in refused(f"simulate chain {line}")["message"]


def test_no_digit_of_a_uniform_spread_is_lost() -> None:
    spread = 0.123456789012345
    chain = OscillatorChain(
        damping="k*y**2 - 1", c=0.1, values={"k": 1.0}, disorder={"k": f"uniform:{spread!r}"}
    )
    assert chain.disorder["k"] == f"uniform:{spread!r}"


@pytest.mark.parametrize("eta", [0.004, 0.0236, 0.12])
def test_the_relaxation_time_of_the_paper_is_two_in_slow_time_in_every_form(eta: float) -> None:
    """φ' = -φ/2 at rest; deviations from the unstable cycle grow at most at the rate 1."""
    built_in = VdpChain(a=1.0, b=eta, c=0.6, eps=0.02)
    text = OscillatorChain(
        damping="1 - y**2 + b*y**4", values={"b": eta}, c=0.6, eps=0.02, sites=40
    )
    linked = text.replace(coupling="next-nearest:1,0.2", drive="0.1,2@3")
    for chain in (built_in, built_in.averaged(), text, text.averaged(), linked):
        assert chain.relaxation_time == pytest.approx(100.0, rel=1e-6)
    for chain in (text, linked):
        assert SmoothChain.relaxation_time.__get__(chain) == pytest.approx(100.0, rel=1e-6)


def test_without_linear_damping_it_is_the_time_near_the_unstable_cycle_that_counts() -> None:
    """H = s/4 - s²/8 + 5bs³/64, A' = -(A/2)H(A²): deviations from H = 0 grow at the rate -sH'."""
    b = 0.0233
    chain = OscillatorChain(damping="y**2 - y**4 + b*y**6", values={"b": b}, c=1.0)
    s = min(np.roots([5.0 * b / 64.0, -1.0 / 8.0, 1.0 / 4.0]).real)
    growth = -s * (1.0 / 4.0 - s / 4.0 + 15.0 * b * s**2 / 64.0)
    assert chain.relaxation_time == pytest.approx(2.0 / growth / chain.eps, rel=1e-4)
    assert SmoothChain.relaxation_time.__get__(chain) == math.inf
    self_excited = OscillatorChain(damping="y**2 - 1", c=1.0)
    assert self_excited.relaxation_time == math.inf


def test_the_time_near_the_unstable_cycle_is_that_of_a_run_of_an_anharmonic_cell() -> None:
    """Maxima of y by scipy, from above and from below the cycle; to first order in ε."""
    eps, cell = 1e-4, {"damping": "y**2 - y**4 + 0.1*y**6", "stiffness": "y + 2*y**3"}
    chain = OscillatorChain(**cell, c=1.0, eps=eps)

    def rate(_: float, x: Any) -> list[float]:
        y, v = x
        return [v, -y - 2.0 * y**3 - eps * v * (y**2 - y**4 + 0.1 * y**6)]

    def turns(_: float, x: Any) -> float:
        return float(x[1])

    turns.direction = -1.0  # type: ignore[attr-defined]
    ends = []
    for side in (0.98, 1.02):
        start = [side * chain.unstable_amplitude, 0.0]
        options: dict[str, Any] = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
        run = solve_ivp(rate, (0.0, 400.0), start, events=turns, **options)
        ends.append((run.t_events[0][-1], run.y_events[0][-1][0]))
    apart = (ends[1][1] - ends[0][1]) / (0.04 * chain.unstable_amplitude)
    growth = math.log(apart) / ends[0][0]
    assert chain.relaxation_time == pytest.approx(2.0 / growth, rel=0.02)


def test_a_chain_without_inertia_needs_no_relaxation_time() -> None:
    chain = OscillatorChain(damping=0, stiffness="y*(1 - y)*(0.2 - y)", overdamped=True, c=1.0)
    assert chain.relaxation_time == 0.0
    assert SmoothChain.relaxation_time.__get__(chain) == 0.0
