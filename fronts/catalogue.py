"""The commands of ``fronts``, with the function of the library that each calls for each model.

Every command is one entry here. Its options, their help texts and their defaults are derived from
the function and the class of the chain (`fronts.signatures`); its answer is the function's result.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any


@dataclass(frozen=True, kw_only=True)
class CommandCall:
    """A public function behind a command; this base class is used if it takes no chain.

    Attributes
    ----------
    function : str
        ``module:name`` of the function, which is imported when the command runs.
    presets : mapping
        Defaults of this command for parameters that have none, or another one, in the library.
    hidden : tuple of str
        Parameters that are not options: those of the function by their names, others with a
        prefix, as in ``chain.ends``.
    ranges : mapping of str to str
        ``module:NAME`` of the range that the function allows for a field of the chain, where it
        is narrower than that of the field.
    choices : str
        ``module:name`` of a function that returns, for the class of the chain, the words that an
        option may have and its help, by parameter; empty if they are the same for all models.
    kinds : tuple of str
        The kinds of chains that the model may be, of those with which sentences in the docstring of
        the function begin (`fronts.signatures.KINDS`); empty if there are none.
    """

    function: str
    presets: Mapping[str, Any] = field(default_factory=dict)
    hidden: tuple[str, ...] = ()
    ranges: Mapping[str, str] = field(default_factory=dict)
    choices: str = ""
    kinds: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class RunCall(CommandCall):
    """A simulation of a chain.

    Attributes
    ----------
    start : str
        ``module:name`` of the function that makes the argument ``start`` from the chain; its
        parameters are options too.
    """

    function: str = "verification.runs.simulate:simulate"
    start: str = "fronts.initial_state:prepared"


@dataclass(frozen=True, kw_only=True)
class MapCall(CommandCall):
    """A map of the states of a chain over axes, which are the parameters given as ranges.

    Attributes
    ----------
    axes : mapping of str to (float, float, int)
        Parameters that are ranges by default, unless two others are given as ranges, in the order
        of the table. Each further parameter given as a range is an axis too.
    """

    function: str = "fronts.maps:mapped"
    axes: Mapping[str, tuple[float, float, int]] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class MeasurementCall(CommandCall):
    """A measurement on a chain; if one of the chain's fields is a range, the result is a curve.

    Attributes
    ----------
    fixed : mapping
        Fields of the chain that are not options, because the function does not depend on them.
    cell : str
        ``module:Class`` of a cell that the function takes in place of a chain.
    curve : str
        ``module:name`` of a function that computes a curve in a better way than point by point,
        from the chains at both ends of the range, the parameter in which they differ, and its
        values; it returns None where there is no better way.
    only : mapping of str to tuple of str
        Options that belong to certain values of ``--method`` only.
    sites : str
        ``module:name`` of a function that returns the default length of the chain for a given size
        of the nucleus.
    """

    fixed: Mapping[str, Any] = field(default_factory=dict)
    cell: str = ""
    curve: str = ""
    only: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    sites: str = ""


@dataclass(frozen=True, kw_only=True)
class Command:
    """A command: one call, or one for each model.

    Attributes
    ----------
    line : str
        Description in one line.
    examples : str
        Working command lines, shown by ``--help``.
    calls : mapping of str to CommandCall
        The calls by model; the key is empty if there is only one, and `EVERY` stands for each
        further model that is registered in `theory.chains.chain.CHAINS`.
    notes : str
        Further text at the end of ``--help``.
    default : str
        The model that is used if none is named.
    module : str
        For a command that does not compute a single `Result`: a module of `fronts.commands` with an
        ``EXAMPLE`` and a function of the same name, from whose signature and docstring the options
        are derived.
    """

    line: str
    examples: str = ""
    notes: str = ""
    calls: Mapping[str, CommandCall] = field(default_factory=dict)
    default: str = ""
    module: str = ""


EVERY = "*"
"""Any further registered model with a number of sites."""

ALIASES = {"envelope": "averaged"}
"""Alternative names of models."""

_FIG_7 = {"chain.a": 2.5, "chain.b": 0.5}
"""Damping coefficients of Figs. 7-11."""

_FRONT = "verification.fronts.measure:measure_front"
_OF_RUNNING_FRONTS = (
    "accuracy", "tolerance", "excited", "max_sites", "stall_time", "left_boundary",
)  # fmt: skip
_SMOOTH = ("Smooth chain",)
_OWN_FRONT = MeasurementCall(
    function=_FRONT,
    hidden=("point", "method"),
    kinds=(
        *_SMOOTH, "Lattice", "Lattice or network", "Lattice with directions, or network",
    ),
)  # fmt: skip

_VDP_RUN = RunCall(
    presets={**_FIG_7, "chain.c": 0.1, "t_end": 2000.0}, hidden=("start.start_point",)
)

_CELL = "verification.cells.cell:cell"
_ALONE = {"c": 0.0, "sites": 2, "ends": "free"}
_VDP_CELL = MeasurementCall(function=_CELL, fixed=_ALONE, presets=_FIG_7)
_OWN_CELL = MeasurementCall(
    function=_CELL,
    fixed={
        **_ALONE, "coupling": "chain", "velocity_coupling": 0.0, "disorder": {}, "seed": 0,
        "drive": (), "shape": None, "overdamped": False,
    },
)  # fmt: skip

_VDP_MAP = MapCall(
    presets={"chain.sites": 16},
    axes={"eta": (0.01, 0.14, 14), "c": (0.05, 1.0, 20)},
    hidden=("start_point", "nucleus.pattern", "chain.ends"),
)

_BREATHER = "verification.breathers.breather:breather"
_OF_BREATHERS = {"reading": ("closed-form",), "seed": ("simulation",)}
_VDP_BREATHER = MeasurementCall(
    function=_BREATHER,
    presets={**_FIG_7, "chain.c": 0.1},
    curve="fronts.branches:breather_branch",
    only=_OF_BREATHERS,
    sites="theory.chains.nucleus:sites_for",
)

_THRESHOLD = MeasurementCall(
    function="verification.thresholds.threshold:threshold",
    fixed={"c": 0.0},
    choices="verification.thresholds.threshold:choices",
)
_OF_BISECTION = ("final_time", "accuracy", "lowest", "highest", "tests", "displacement")
_VDP_THRESHOLD = replace(
    _THRESHOLD,
    fixed={"c": 0.0, "sites": 31},
    presets=_FIG_7,
    only={
        **dict.fromkeys(("perturbation", "seed"), ("sweep", "hold")),
        **dict.fromkeys(_OF_BISECTION, ("bisection",)),
    },
    hidden=("start_point",),
)

COMMANDS: dict[str, Command] = {
    "kinetic": Command(
        line="every velocity at which the piecewise-linear front can travel (Eq. 54)",
        examples="""
  fronts kinetic --c 0.5 --eta 0.03125
  fronts kinetic --c 0.45 --a 4 --b 0.5 --json
  fronts kinetic --c 0.5 --eta 0.03125 --certify
  fronts kinetic --c 0.3:3:200 --eta 0.03125 --out curve.png
  fronts kinetic --c 0.3 --eta 0.001:0.12:200 --out curve.csv""",
        calls={"": CommandCall(function="fronts.piecewise.kinetic_relation:kinetic_relation")},
    ),
    "sum": Command(
        line="the sum of the kinetic relation, by five methods (Eq. 53)",
        examples="""
  fronts sum --v 0.3 --c 0.5
  fronts sum --v 0.3 --c 0.5 --method series --digits 50 --json""",
        calls={"": CommandCall(function="fronts.piecewise.sigma:sigma")},
    ),
    "roots": Command(
        line="labelled complex roots of the dispersion relation (Eqs. 50-52)",
        examples="""
  fronts roots --v 0.3 --c 0.5 --count 8
  fronts roots --v 0.3 --c 0.5 --extent 40 --certify --json
  fronts roots --v 0.3 --c 0.5 --count 4 --digits 40""",
        calls={"": CommandCall(function="fronts.piecewise.roots:roots")},
    ),
    "profile": Command(
        line="the shape of the front (Eq. 49) and whether it is admissible (Eq. 47)",
        examples="""
  fronts profile --c 0.5 --eta 0.03125
  fronts profile --c 0.5 --a 4 --b 0.5 --out profile.png
  fronts profile --c 0.45 --eta 0.03125 --branch 1 --from -5 --to 5 --out profile.csv""",
        calls={"": CommandCall(function="fronts.piecewise.profile:front_profile")},
    ),
    "front": Command(
        line="velocity of a front, by simulation or as a travelling wave (Eqs. 5, 8, 43, 44)",
        examples="""
  fronts front piecewise --c 0.5 --eta 0.03125
  fronts front piecewise --c 0.44 --a 4 --b 0.5 --start resting --json
  fronts front averaged --c 0.6 --a 4 --b 0.5
  fronts front averaged --c 0.6 --eta 0.03125 --method wave
  fronts front averaged --c 0.05:2:40 --eta 0.03125 --method wave --out branch.png
  fronts front averaged --c 0.15 --eta 0.01:0.08:36 --method wave --out branch.png
  fronts front vdp --c 0.6 --a 4 --b 0.5 --eps 0.01 --json
  fronts front vdp --c 0.5:2:7 --a 4 --b 0.5 --workers 2 --out fig13.png
  fronts front friction --c 0.02 --n 101
  fronts front friction --c 0.02:0.1:5 --out fig06.png
  fronts front friction --c 0.008 --excited 6 --v-d 1.25 --json
  fronts front chain --damping "1 - 4*y**2 + y**4/2" --c 0.6 --coupling next-nearest:1,0.2
  fronts front chain --damping "1 - 4*y**2 + y**4/2" --c 0.6 --coupling square --n 41x41 \\
      --directions 8
  fronts front averaged-chain --damping "1 - 4*y**2 + y**4/2" --c 0.6""",
        calls={
            "piecewise": MeasurementCall(
                function="verification.fronts.switchings:front_by_switchings"
            ),
            "vdp": MeasurementCall(
                function=_FRONT,
                presets={"chain.sites": 32},
                hidden=("point", "chain.ends", "method", "directions"),
                kinds=_SMOOTH,
            ),
            "averaged": MeasurementCall(
                function=_FRONT,
                presets={"chain.sites": 32},
                curve="fronts.branches:front_branch",
                hidden=("point", "chain.ends", "directions"),
                only=dict.fromkeys(_OF_RUNNING_FRONTS, ("run",)),
                kinds=_SMOOTH,
            ),
            "friction": MeasurementCall(
                function=_FRONT,
                presets={"chain.sites": 101},
                hidden=("left_boundary", "chain.ends", "method", "directions"),
                kinds=("Friction chain",),
            ),
            "chain": _OWN_FRONT,
            "averaged-chain": _OWN_FRONT,
            EVERY: MeasurementCall(
                function=_FRONT,
                hidden=("point", "chain.ends", "method", "directions"),
                kinds=_SMOOTH,
            ),
        },
    ),
    "simulate": Command(
        line="simulation of a chain with some sites excited initially (Eqs. 5, 8, 43)",
        examples="""
  fronts simulate vdp --n 31 --a 2.5 --b 0.5 --c 0.1 --excite 15 --t-end 2000
  fronts simulate vdp --n 31 --a 2.5 --b 0.5 --c 0.25 --excite 15 --t-end 20000 \\
      --out run.npz --picture run.png
  fronts simulate averaged --n 60 --a 4 --b 0.5 --c 0.6 --excite 1:3 --t-end 9000
  fronts simulate friction --n 31 --c 0.02 --excite 1 --t-end 1000 --picture run.png
  fronts simulate chain --damping "1 - a*y**2 + b*y**4" --value a=4 --value b=0.5 --c 0.6
  fronts simulate chain --damping "1 - 4*y**2 + y**4/2" --c 0.6 --coupling square --n 21x21
  fronts simulate averaged-chain --damping "v**2 - 1" --c 0.5 --t-end 500
  fronts simulate chain --model mine.toml --coupling next-nearest:1,0.2 --disorder a=0.05""",
        calls={
            "vdp": _VDP_RUN,
            "averaged": _VDP_RUN,
            "friction": RunCall(presets={"chain.c": 0.02, "t_end": 1000.0}, hidden=("level",)),
            EVERY: RunCall(presets={"t_end": 1000.0}, hidden=("start.start_point",)),
        },
    ),
    "cell": Command(
        line="rest state, cycles and basin of attraction of a single oscillator (Fig. 2; Eqs. 2-8)",
        examples="""
  fronts cell friction --v-d 1.25
  fronts cell friction --v-d 1.25 --xi 0 --json
  fronts cell friction --v-d 0.9:2:200 --out cell.png
  fronts cell vdp --a 2.5 --b 0.5
  fronts cell averaged --a 2.5 --b 0.4:0.8:9
  fronts cell friction --law stribeck --v-s 0.3
  fronts cell chain --damping "y**2 - 1" --eps 1""",
        notes="""In JSON, null means that a value does not exist or is infinite, as "status" says.
"basin" is the range of y from which the cell comes to rest if it is released with zero velocity;
it is null if there is no such y, and [null, null] if it comes to rest from every y.""",
        calls={
            "friction": MeasurementCall(
                function=_CELL,
                cell="theory.cells.friction:FrictionCell",
                curve="verification.cells.diagram:bifurcation",
            ),
            "vdp": replace(_VDP_CELL, ranges={"eps": "verification.cells.vdp:EPS_RANGE"}),
            "averaged": replace(_VDP_CELL, hidden=("tolerance",)),
            "chain": _OWN_CELL,
        },
    ),
    "map": Command(
        line="the state of a chain over a plane of parameters (Figs. 5, 15)",
        examples="""
  fronts map averaged --eta 0.01:0.14:7 --c 0.05:1:7
  fronts map averaged --eta 0.01:0.14:14 --c 0.05:1:20 --out map.csv --picture map.png
  fronts map vdp --eta 0.01:0.14:14 --c 0.05:1:20 --refine 0 --out map.csv --resume
  fronts map friction --c 0:0.1:11 --v-d 1:2:11
  fronts map friction --c 0:0.1:21 --v-d 1:2:21 --out map.csv --picture map.png
  fronts map friction --c 0:0.1:21 --v-d 1:2:21 --nucleus 9 --out wide.csv --resume
  fronts map averaged --eta 0.01:0.14:14 --c 0.05:1:20 --amplitudes --out map.zarr
  fronts map chain --damping "1 - 4*y**2 + y**4/2" --c 0.2:0.6:3 --n 8 --refine 0
  fronts map averaged-chain --damping "1 - 4*y**2 + y**4/2" --c 0.05:0.6:5 --n 16""",
        notes="""A map is a plane: a parameter with a default range takes it only if fewer than two
others are given as ranges. Otherwise v_d is 1.25, a and b replace eta, and c must be given.
The paper does not say whether a or b is kept constant while eta varies: here b = 0.5 is,
unless --a or another --b is given. In addition to a table OUT.csv, the command writes
OUT.csv.json, with parameters and versions, and OUT-boundary.csv, with the boundaries.""",
        calls={
            "vdp": replace(_VDP_MAP, ranges={"eps": "verification.maps.vdp_rules:EPS_RANGE"}),
            "averaged": _VDP_MAP,
            "friction": MapCall(
                axes={"c": (0.0, 0.1, 21), "v_d": (1.0, 2.0, 21)},
                hidden=("displacement", "nucleus.pattern"),
            ),
            EVERY: MapCall(hidden=("start_point", "nucleus.pattern")),
        },
    ),
    "breather": Command(
        line="a localised oscillation of the Van der Pol chain, by four methods (Eqs. 8-43)",
        examples="""
  fronts breather --c 0.1
  fronts breather --c 0.1 --method all
  fronts breather --c 0.19 --a 2.5 --b 0.5 --eps 0.01 --method orbit --json
  fronts breather --c 0.1 --nucleus 3 --pattern=-+ --method envelope
  fronts breather --c 0.195 --method closed-form --reading tail
  fronts breather vdp --c 0.05:0.25:9 --method orbit --out branch.png
  fronts breather averaged --c 0.1
  fronts breather chain --damping "1 - 2.5*y**2 + y**4/2" --c 0.1""",
        default="vdp",
        calls={
            "vdp": _VDP_BREATHER,
            "chain": MeasurementCall(function=_BREATHER, hidden=("method", "reading", "seed")),
            "averaged": _VDP_BREATHER,
        },
    ),
    "threshold": Command(
        line="the coupling at which a nucleus stops being localised (Figs. 4, 11)",
        examples="""
  fronts threshold vdp --nucleus 3
  fronts threshold vdp --nucleus 1 --method orbit --json
  fronts threshold vdp --nucleus 5 --method sweep
  fronts threshold vdp --nucleus 3 --method sweep --perturbation 1e-6 --seed 1
  fronts threshold vdp --nucleus 1 --place edge
  fronts threshold vdp --b 0.3:0.7:9 --out threshold.png
  fronts threshold averaged --nucleus 1
  fronts threshold friction --place edge --nucleus 1
  fronts threshold friction --nucleus 3 --definition whole --final-time 2000 --json
  fronts threshold friction --v-d 1.2:1.4:3 --place edge --accuracy 1e-4
  fronts threshold chain --damping "1 - 2.5*y**2 + y**4/2" --method orbit --n 7
  fronts threshold averaged-chain --damping "1 - 2.5*y**2 + y**4/2" --accuracy 1e-4""",
        calls={
            "vdp": _VDP_THRESHOLD,
            "averaged": _VDP_THRESHOLD,
            "friction": replace(
                _THRESHOLD,
                hidden=("nucleus.pattern", "method", "perturbation", "seed"),
            ),
            "chain": replace(
                _THRESHOLD,
                hidden=("perturbation", "seed", "start_point"),
            ),
            EVERY: replace(
                _THRESHOLD,
                hidden=("method", "perturbation", "seed", "start_point"),
            ),
        },
    ),
    "derive": Command(
        line="checked derivations of all equations, and of your own cell (Eqs. 1-54)",
        module="derive",
    ),
    "stress": Command(
        line="comparison of every quantity with another method over all parameter ranges",
        module="stress",
    ),
    "bench": Command(
        line="error versus run time, compared with other programs (source tree only)",
        module="bench",
    ),
    "explore": Command(
        line="an interactive page with sliders, in a browser on this machine", module="explore"
    ),
    "check": Command(line="the verdict on each claim of the paper", module="check"),
    "article": Command(
        line="a replication article of two pages, from the report of a check", module="article"
    ),
}
"""Every command; the overview lists them in this order."""
