"""The definitions that a function reaches, found by reading source and running none of it.

A function reaches what its body names, and all that those definitions name in their turn, through
imports, also those inside functions. A class is reached with all of its methods; annotations reach
nothing. Of a module of which anything is reached, and of the packages it is in, the statements that
define no name count as well. What is registered for a reached function, as with
`functools.singledispatch`, is reached in every module that the roots import. A module that is
itself passed about, or of which a name is asked that its text does not define, counts as a whole,
and an import by a computed name as all of its package.
"""

from __future__ import annotations

import ast
import functools
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from verification.execution.imports import (
    closure,
    imports_by_computed_name,
    is_for_types,
    modules_below,
    names_imported,
    source_of,
)

Definition = tuple[str, str]
"""Dotted name of a module, and a name in it or one of the next two."""
EVERYTHING, ON_IMPORT = "*", ""
_DEFINING = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Assign, ast.AnnAssign)
_NO_CODE = ("ctx", "kind", "type_comment")


@dataclass(frozen=True, kw_only=True)
class Source:
    """A module as it is written.

    Attributes
    ----------
    statements : mapping
        At top level by the names that they define; under `ON_IMPORT` those that define none, or
        that do more than that.
    imports : mapping
        What it imports at top level, dotted, by the names that it has here.
    """

    statements: Mapping[str, tuple[ast.stmt, ...]]
    imports: Mapping[str, str]


def reached(
    roots: Iterable[str], packages: Collection[str], without: Collection[str] = ()
) -> list[tuple[str, str]]:
    """Return the definitions that modules or functions reach, with their code, sorted.

    Parameters
    ----------
    roots : iterable of str
        Modules by their dotted names, or functions as ``package.module:function``.
    packages : collection of str
        Top-level packages that are followed.
    without : collection of str, optional
        Modules that are left out, and not followed.

    Raises
    ------
    ValueError
        If there is no such module.

    Examples
    --------
    >>> [name for name, _ in reached(["theory.parameters:within"], ["theory"])][-2:]
    ['theory.parameters:number', 'theory.parameters:within']
    """
    search = _search(frozenset(packages), frozenset(without), _state(frozenset(packages)))
    waiting: list[Definition] = []
    registered: dict[Definition, list[Definition]] = defaultdict(list)
    for root in roots:
        module, _, name = root.partition(":")
        found = closure(module, packages, without)
        if module not in found:
            raise ValueError(f"there is no module {module} whose code could be read")
        waiting.append((module, name if name in _source(module).statements else EVERYTHING))
        for each in found:
            for dispatcher in search.registrations(each):
                registered[dispatcher].append((each, _registration(dispatcher)))
    texts: dict[Definition, str] = {}
    while waiting:
        here = waiting.pop()
        if here in texts or here[0] in without:
            continue
        texts[here], following = search.follow(here)
        waiting += [*following, *registered[here]]
    return [(":".join(here), texts[here]) for here in sorted(texts)]


class _Search:
    """Follows definitions of some packages, each one once."""

    def __init__(self, packages: frozenset[str], without: frozenset[str]) -> None:
        self._packages, self._without = packages, without
        self._followed: dict[Definition, tuple[str, tuple[Definition, ...]]] = {}
        self._registered: dict[str, dict[Definition, list[ast.stmt]]] = {}

    def follow(self, here: Definition) -> tuple[str, tuple[Definition, ...]]:
        """Return the code of a definition, and what it reaches at once."""
        if here not in self._followed:
            module, package = here[0], _package_of(here[0])
            read = [_read_statement(each, package) for each in self._statements(*here)]
            named = {each for one in read for each in self._named(one, module)}
            named |= {(each, ON_IMPORT) for each in _beginnings(module)}
            self._followed[here] = "\n".join(one.shape for one in read), tuple(named)
        return self._followed[here]

    def registrations(self, module: str) -> Mapping[Definition, list[ast.stmt]]:
        """Return what a module registers, as ``@function.register``, by those functions."""
        if module not in self._registered:
            found: dict[Definition, list[ast.stmt]] = defaultdict(list)
            for held in _source(module).statements.values():
                for statement in held:
                    for holder in _registered_with(statement):
                        for dispatcher in self._named(_read_statement(holder, ""), module):
                            found[dispatcher].append(statement)
            self._registered[module] = found
        return self._registered[module]

    def _statements(self, module: str, name: str) -> Iterable[ast.stmt]:
        if source_of(module) is None:
            return ()
        held = _source(module).statements
        if name == EVERYTHING:
            return [each for several in held.values() for each in several]
        for dispatcher, statements in self.registrations(module).items():
            if name == _registration(dispatcher):
                return statements
        return held.get(name, ())

    def _named(self, read: _Statement, module: str) -> Iterator[Definition]:
        """Yield the definitions that a statement of a module names."""
        source = _source(module)
        known = {**source.imports, **read.imports}
        for dotted in read.uses:
            head = dotted.partition(".")[0]
            target = next((name for name in _beginnings(dotted) if name in known), None)
            if target is not None:
                yield from self._find(known[target] + dotted[len(target) :])
            elif head in source.statements:
                yield module, head
        if read.imports_computed:
            yield from ((each, EVERYTHING) for each in modules_below(module.partition(".")[0]))

    def _find(self, dotted: str) -> Iterator[Definition]:
        """Yield the definition of a dotted name, through what modules import from others."""
        if dotted.partition(".")[0] not in self._packages:
            return
        module = next((name for name in _beginnings(dotted) if source_of(name)), None)
        if module is None or module in self._without:
            return
        source, (name, _, rest) = _source(module), dotted[len(module) + 1 :].partition(".")
        if name in source.statements:
            yield module, name
        elif name in source.imports:
            yield from self._find(".".join(filter(None, [source.imports[name], rest])))
        else:
            yield module, EVERYTHING


@functools.lru_cache(maxsize=4)
def _search(packages: frozenset[str], without: frozenset[str], _state: int) -> _Search:
    return _Search(packages, without)


def _state(packages: frozenset[str]) -> int:
    """Return what changes when a file of some packages changes, is added or is removed."""
    found = []
    for package in packages:
        home = source_of(package)
        for path in home.parent.rglob("*.py") if home else ():
            status = path.stat()
            found.append((str(path), status.st_mtime_ns, status.st_size))
    return hash(frozenset(found))


def _registration(dispatcher: Definition) -> str:
    return f"@{':'.join(dispatcher)}"


def _registered_with(statement: ast.stmt) -> Iterator[ast.expr]:
    for each in getattr(statement, "decorator_list", ()):
        called = each.func if isinstance(each, ast.Call) else each
        if isinstance(called, ast.Attribute) and called.attr == "register":
            yield called.value


@dataclass(frozen=True, kw_only=True)
class _Statement:
    """What a statement does, which dotted names it uses, and what it imports by which names."""

    shape: str
    uses: frozenset[str]
    imports: Mapping[str, str]
    imports_computed: bool


def _read_statement(statement: ast.AST, package: str) -> _Statement:
    return _Statement(
        shape=shape(statement),
        uses=frozenset(_uses(statement)),
        imports=_imports_within(statement, package),
        imports_computed=imports_by_computed_name(statement),
    )


def _beginnings(dotted: str) -> Iterator[str]:
    """Yield a dotted name, and what is left of it when names are taken from its end."""
    while dotted:
        yield dotted
        dotted = dotted.rpartition(".")[0]


def _package_of(module: str) -> str:
    path = source_of(module)
    inside = path is not None and path.name == "__init__.py"
    return module if inside else module.rpartition(".")[0]


def _source(module: str) -> Source:
    path = source_of(module)
    if path is None:
        raise ValueError(f"there is no module {module} whose code could be read")
    status = path.stat()
    return _read(module, path, status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=4096)
def _read(module: str, path: Path, _changed: int, _size: int) -> Source:
    package = _package_of(module)
    statements: dict[str, list[ast.stmt]] = defaultdict(list)
    imports: dict[str, str] = {}
    for each in ast.parse(path.read_bytes(), str(path)).body:
        if _is_text(each) or is_for_types(each):
            continue
        here = names_imported(each, package)
        imports |= here
        if here:
            continue
        if not isinstance(each, _DEFINING):
            imports |= _imports_within(each, package)
            statements[ON_IMPORT].append(each)
        for name in _defined(each) or (ON_IMPORT,):
            statements[name].append(each)
    held = {name: tuple(several) for name, several in statements.items()}
    return Source(statements=held, imports=imports)


def _defined(statement: ast.stmt) -> tuple[str, ...]:
    if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        return (statement.name,)
    return tuple(
        node.id
        for node in ast.walk(statement)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    )


def _imports_within(statement: ast.AST, package: str) -> dict[str, str]:
    found: dict[str, str] = {}
    for node in ast.walk(statement):
        found |= names_imported(node, package)
    return found


def _uses(node: ast.AST) -> Iterator[str]:
    """Yield the dotted names that some code uses, annotations aside."""
    dotted = _dotted(node)
    if dotted:
        yield dotted
        return
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns"):
            continue
        for each in value if isinstance(value, list) else [value]:
            if isinstance(each, ast.AST):
                yield from _uses(each)


def _dotted(node: ast.AST) -> str:
    names: list[str] = []
    while isinstance(node, ast.Attribute):
        names.append(node.attr)
        node = node.value
    return ".".join([node.id, *reversed(names)]) if isinstance(node, ast.Name) else ""


def shape(node: ast.AST) -> str:
    """Return what code does: its syntax tree without places, docstrings, comments and layout.

    It is the same on every version of Python, which `ast.dump` is not.

    Examples
    --------
    >>> shape(ast.parse("x = (1+2)  # one")) == shape(ast.parse("x = 1 + 2"))
    True
    """
    parts: list[str] = []
    for name, value in ast.iter_fields(node):
        if value is None or value == [] or name in _NO_CODE:
            continue
        several = value if isinstance(value, list) else [value]
        parts.append(f"{name}=[{','.join(_part(each) for each in several if not _is_text(each))}]")
    return f"{type(node).__name__}({';'.join(parts)})"


def _part(value: object) -> str:
    return shape(value) if isinstance(value, ast.AST) else repr(value)


def _is_text(node: object) -> bool:
    """Tell whether a statement is a string and nothing else, as a docstring is."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )
