"""A force of a cell given as functions that numba compiles, in place of a polynomial.

It provides what the right-hand side of a chain needs from a `Polynomial`: parameter names and text.
"""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache, partial
from typing import Any

from theory.cells.function_content import function_content, independent_copy
from theory.cells.polynomial import Polynomial, as_polynomial
from theory.parameters import ParameterError

Function = Callable[..., Any]


@dataclass(frozen=True, repr=False)
class CompiledForce:
    """A function of y, or of y and v, and of named parameters, with its derivatives if given.

    Attributes
    ----------
    symbol : str
        g or h, the symbol of the function in the equation.
    functions : tuple of callable
        The force and, optionally, its derivatives by y and, for h, by v; all compiled by
        ``numba.njit`` and with the same arguments. The arguments after y (and v) are named
        parameters of the chain. Copies are stored, so that the digest remains true.
    digest : str
        Digest of the code of the functions and of the values that they capture.

    Raises
    ------
    ParameterError
        If a function is not compiled, has other arguments, or captures a value whose content cannot
        be read, or if there are too few or too many functions.
    """

    symbol: str
    functions: tuple[Function, ...]
    digest: str = field(init=False)

    def __post_init__(self) -> None:
        allowed = f"{self._call}, or that and its derivatives by {' and '.join(self.variables)}"
        if len(self.functions) not in (1, 1 + len(self.variables)):
            raise ParameterError(
                self.symbol, f"{len(self.functions)} functions", allowed, "give all, or none"
            )
        for each in self.functions:
            if not hasattr(each, "py_func"):
                raise ParameterError(
                    self.symbol, getattr(each, "__name__", type(each).__name__),
                    "compiled by numba", "write @numba.njit above the function",
                )  # fmt: skip
            arguments = _arguments(each)
            if arguments != (*self.variables, *self.names) or {"y", "v"} & {*self.names}:
                raise ParameterError(
                    f"arguments of {each.__name__}", ", ".join(arguments), allowed,
                    "use these names for the variables, then the named parameters, in the same "
                    "order in all functions",
                )  # fmt: skip
        content = "\n".join(map(function_content, self.functions))
        digest = hashlib.sha256(content.encode()).hexdigest()[:12]
        object.__setattr__(self, "digest", digest)
        object.__setattr__(self, "functions", _copies(self.functions, digest))

    @property
    def variables(self) -> tuple[str, ...]:
        """The arguments that come first: y, or y and v."""
        return ("y",) if self.symbol == "g" else ("y", "v")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, in the order of the arguments."""
        return _arguments(self.functions[0])[len(self.variables) :]

    @property
    def _call(self) -> str:
        return f"{self.symbol}({', '.join(self.variables)})"

    @property
    def has_derivatives(self) -> bool:
        """Whether the derivatives are given."""
        return len(self.functions) > 1

    def source(self, variable: str = "") -> str:
        """Return the call of the force, or of a derivative, in the text of a right-hand side."""
        arguments = ", ".join([*self.variables, *self.names])
        return f"{self._name(variable)}({arguments})"

    @property
    def namespace(self) -> tuple[tuple[str, Function], ...]:
        """The functions, with the names that :meth:`source` uses for them."""
        variables = ("", *self.variables)
        return tuple(
            (self._name(each), function)
            for each, function in zip(variables, self.functions, strict=False)
        )

    def _name(self, variable: str) -> str:
        return "_".join(["", self.symbol, *([variable] if variable else [])])

    def function(self, values: Mapping[str, float], variable: str = "") -> Callable[..., float]:
        """Return the force, or a derivative, as a function of numbers y (and v)."""
        function = dict(self.namespace)[self._name(variable)]
        return partial(_value, function, tuple(values[name] for name in self.names))

    def check(self, values: Mapping[str, float]) -> None:
        """Compile the functions by calling them once with these values of the parameters.

        Raises
        ------
        ParameterError
            If numba cannot compile one, or it does not return a number.
        """
        for each in self.functions:
            try:
                float(each(*(0.0 for _ in self.variables), *(values[name] for name in self.names)))
            except Exception as error:  # raised by numba or by the function itself
                raise ParameterError(
                    f"function {each.__name__}", type(error).__name__,
                    "one of numbers that numba compiles and that returns a number",
                    "call it directly to see what fails",
                ) from error  # fmt: skip

    def __str__(self) -> str:
        """Return the name of the force in results."""
        arguments = ", ".join([*self.variables, *self.names])
        return f"compiled {self.functions[0].__name__}({arguments}) {self.digest}"

    __repr__ = __str__


@lru_cache(maxsize=256)
def _copies(functions: tuple[Function, ...], digest: str) -> tuple[Function, ...]:
    """Return copies of functions, the same ones for as long as their digest is the same."""
    made: dict[int, Any] = {}
    return tuple(independent_copy(each, made) for each in functions)


def _value(function: Function, parameters: tuple[float, ...], *variables: float) -> float:
    return float(function(*variables, *parameters))


def read_force(given: Any, quantity: str) -> Polynomial | CompiledForce:
    """Return a damping or a stiffness: a polynomial, or compiled functions.

    Parameters
    ----------
    given : str, number, SymPy expression, function or sequence of them
        A polynomial, a function compiled by numba, or such a function and its derivatives.
    quantity : str
        ``damping`` or ``stiffness``.

    Raises
    ------
    ParameterError
        If it is none of these.
    """
    if isinstance(given, CompiledForce):
        return given
    functions = tuple(given) if isinstance(given, (tuple, list)) else (given,)
    if functions and all(
        callable(each) and not hasattr(each, "free_symbols") for each in functions
    ):
        return CompiledForce("g" if quantity == "stiffness" else "h", functions)
    return as_polynomial(given, quantity)


def _arguments(function: Function) -> tuple[str, ...]:
    plain: Any = getattr(function, "py_func", function)
    return tuple(inspect.signature(plain).parameters)
