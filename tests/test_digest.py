"""A stored measurement is stale when the code it is of has changed, and only then."""

import ast
import bisect
import cmath
import math
import os
import pkgutil
import sys
from dataclasses import dataclass
from functools import lru_cache, partial, wraps
from importlib import import_module
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from numba import njit

from fronts import sigma
from theory.parameters import ParameterError
from verification.execution import digest, metadata
from verification.execution.digest import DRAWING, digest_of_arrays, digest_of_files
from verification.execution.imports import (
    SOURCES,
    closure,
    imports_of,
    is_library,
    shape,
    source_of,
)
from verification.execution.metadata import CHANGED, UNKNOWN, Code, differences, staleness
from verification.execution.task import _TaskReader, code_of, parameters_of

OURS = ("timed_code",)


@pytest.fixture
def package(tmp_path, monkeypatch):
    home = tmp_path / "timed_code"
    home.mkdir()
    (home / "__init__.py").write_text("")
    (home / "deep.py").write_text('"""What."""\n\n\ndef f(x):\n    """Say."""\n    return x + 1\n')
    (home / "top.py").write_text(
        "from timed_code import later\n\n\n"
        "def g(x):\n    from timed_code.deep import f\n    return f(x)\n"
    )
    (home / "other.py").write_text("N = 1\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    yield home
    for name in [name for name in sys.modules if name.startswith("timed_code")]:
        del sys.modules[name]


@pytest.mark.parametrize(
    ("file", "text", "stale"),
    [
        ("deep.py", "def f(x):\n    # a remark\n    return (\n        x + 1\n    )\n", False),
        ("deep.py", "def f(x):  # a remark\n\n    'Other words.'\n    return x + 1\n", False),
        ("deep.py", "def f(x):\n    return x + 2\n", True),
        ("deep.py", "def f(x):\n    if x:\n        pass\n    return x + 1\n", True),
        ("deep.py", "def f(x: int) -> int:\n    return x + 1\n", True),
        ("deep.py", "def f(x):\n    return x + 1\n\n\ndef unused():\n    return 2\n", True),
        ("deep.py", "def f(x):\n    return x + 1\n\n\nprint('imported')\n", True),
        ("deep.py", "def f(x):\n    return x + N\n\n\nN = 1\n", True),
        ("__init__.py", "print('imported')\n", True),
        ("other.py", "N = 2\n", False),
        ("top.py", "def g(x):\n    return x\n", True),
        ("later.py", "N = 1\n", True),  # what was imported may have been a name, and is a module
    ],
)
def test_what_makes_a_record_stale(package, file, text, stale):
    code = Code.of(["timed_code.top"], OURS)
    assert staleness(code, OURS) == ""
    (package / file).write_text(text)
    assert staleness(code, OURS) == (CHANGED if stale else "")


def test_a_record_of_a_module_that_is_gone_is_stale(package):
    code = Code.of(["timed_code.other"], OURS)
    (package / "other.py").unlink()
    assert staleness(code, OURS) == CHANGED
    with pytest.raises(ValueError, match=r"no module timed_code\.other"):
        Code.of(["timed_code.other"], OURS)


def test_a_record_that_names_no_code_is_stale():
    assert staleness(None) == staleness({}) == UNKNOWN


@pytest.mark.parametrize(
    ("one", "other", "alike"),
    [
        ("x = f'{1 + 1:d} # not a remark'", "x = f'{1 + 2:d} # not a remark'", False),
        ("x = 'a'", "x = 'b'", False),
        ("x = 1", "x = 1.0", False),
        ("if a:\n    b\n    c", "if a:\n    b\nc", False),
        ("f(a, b)", "f(a, *b)", False),
        ("x = f(\n    a,  # one\n    b,\n)", "x = f(a, b)", True),
        ("class A:\n    'Say.'\n    n = 1\n    'Of n.'", "class A:\n    n = (1)", True),
        ("x = u'a'", "x = 'a'", True),
    ],
)
def test_the_shape_of_code_keeps_what_it_does_and_nothing_else(one, other, alike):
    assert (shape(ast.parse(one)) == shape(ast.parse(other))) is alike


def test_an_import_counts_wherever_it_stands_but_for_types(tmp_path):
    path = tmp_path / "module.py"
    path.write_text("""
try:
    import p.a
except ImportError:
    import p.b
else:
    from . import c
finally:
    from ..q import d
for _ in ():
    match 1:
        case 1:
            with open(""):
                import p.e
if TYPE_CHECKING:
    import p.f
else:
    lambda: None
    import p.g
if __debug__:
    import p.h
""")
    names, computed = imports_of(path, "r.s")
    assert set(names) == {"p.a", "p.b", "r.s", "r.s.c", "r.q", "r.q.d", "p.e", "p.g", "p.h"}
    assert not computed


def test_a_name_that_is_computed_is_seen_among_other_calls(tmp_path):
    path = tmp_path / "module.py"
    for text, computed in (
        ("print(1)\nimportlib.import_module(name)", True),
        ("print(__import__(name))", True),
        ("import_module = print\nprint(1)", False),
    ):
        path.write_text(text)
        assert imports_of(path, "r.s")[1] is computed


def test_a_benchmark_does_not_depend_on_the_others_nor_on_what_draws():
    held = closure("benchmarks.roots", without=DRAWING, packages=SOURCES)
    needed = {"benchmarks.work_precision", "theory.piecewise.roots"}
    needed.add("verification.quantities.problems")
    assert needed <= set(held)
    assert not {"benchmarks.velocity", "benchmarks.chain", "verification.runs.simulate"} & set(held)
    assert not {"benchmarks.diagram", "paper_checks.pictures"} & set(held)


def test_every_bit_of_an_array_counts_and_so_do_type_shape_and_name():
    arrays = [
        {"a": np.zeros(4)}, {"a": np.zeros((2, 2))}, {"a": np.zeros(4, dtype=np.int64)},
        {"b": np.zeros(4)}, {"a": np.array([0, 0, 0, 5e-324])}, {"a": np.zeros(0)}, {},
    ]  # fmt: skip
    assert len({digest_of_arrays(each) for each in arrays}) == len(arrays)
    square = np.arange(9.0).reshape(3, 3)
    assert digest_of_arrays({"a": square.T}) == digest_of_arrays({"a": square.T.copy()})


def test_no_installed_package_imports_one_that_is_not():
    """Benchmarks are in the source tree only; ``fronts bench`` asks for that tree first."""
    packages = ("theory", "derivations", "verification", "paper_checks", "fronts", "benchmarks")
    root = Path(__file__).parent.parent
    installed = [path for name in packages[:-1] for path in (root / name).rglob("*.py")]
    for path in installed:
        names, _ = imports_of(path, path.parent.relative_to(root).as_posix().replace("/", "."))
        outside = {name for name in names if name.split(".")[0] in ("benchmarks", "tests")}
        assert not outside or path.name == "bench.py", path


def test_every_letter_of_a_file_counts_and_so_do_its_name_and_its_end(tmp_path):
    """Also where two files together hold the same letters."""
    contents = [
        {"a": "one", "b": "two"}, {"a": "one", "b": "twi"}, {"a": "onet", "b": "wo"},
        {"a": "one", "c": "two"}, {"a": "two", "b": "one"}, {"a": "one"}, {},
    ]  # fmt: skip
    found = []
    for texts in contents:
        for name, text in texts.items():
            (tmp_path / name).write_text(text)
        found.append(digest_of_files(tmp_path, [tmp_path / name for name in texts]))
        assert found[-1] == digest_of_files(tmp_path, [tmp_path / name for name in [*texts][::-1]])
    assert len(set(found)) == len(contents)


def test_the_file_of_a_module_is_found_whether_it_is_in_a_package_or_not(monkeypatch):
    assert source_of("bisect") == Path(bisect.__file__)
    assert source_of("json") == Path(sys.modules["json"].__file__)
    assert source_of("verification.execution") == source_of(
        "verification.execution.digest"
    ).with_name("__init__.py")
    assert source_of("no_such_module_anywhere") is source_of("__main__") is None
    assert source_of("bisect.bisect") is None  # a module has none below it
    assert source_of("sys") is source_of("math") is None  # in no file, or in none of Python
    made = ModuleType("made_by_a_loader_of_its_own")
    made.__spec__ = ModuleSpec(made.__name__, None)
    monkeypatch.setitem(sys.modules, made.__name__, made)
    assert source_of(made.__name__) is None  # and this one has no file


def test_a_package_that_python_does_not_find_is_looked_for_beside_this_one(monkeypatch):
    """Some packages of the source tree are not installed."""
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert source_of("benchmarks") == Path(__file__).parents[1] / "benchmarks/__init__.py"


def test_a_library_is_a_module_that_is_installed_but_never_the_script(tmp_path, monkeypatch):
    """A library may be a single file, and a script may be run by a module that is installed."""
    installed = tmp_path / "site-packages"
    installed.mkdir()
    (installed / "one_installed_file.py").touch()
    (tmp_path / "one_file_of_a_user.py").touch()
    for folder in (tmp_path, installed):
        monkeypatch.syspath_prepend(folder)
    (installed / "one_folder_without_init").mkdir()
    assert is_library("one_installed_file")
    assert is_library("one_folder_without_init")
    assert not is_library("one_file_of_a_user")
    is_library.cache_clear()
    for name in ("__main__", "theory"):  # this project is none either where it is installed
        monkeypatch.setattr(sys.modules[name], "__spec__", find_spec("numpy"))
        assert not is_library(name)
    is_library.cache_clear()


@dataclass(frozen=True, slots=True)
class Slotted:
    k: float

    def value(self):
        return self.k

    @classmethod
    def made(cls):
        return cls(1.0)


@dataclass(frozen=True)
class Fieldless:
    def value(self):
        return 1.0


def test_an_object_without_fields_is_told_from_its_class():
    name = f"{__name__}.Fieldless"
    assert parameters_of(Fieldless()) == {"is": name}
    assert parameters_of(Fieldless) == name


class Plain:
    def __init__(self, k):
        self.k = k

    value = Slotted.value


def test_a_method_is_a_task_with_what_its_object_is_and_holds():
    name = f"{__name__}.Slotted"
    slotted = {"is": name, "k": 2.0}
    assert parameters_of(Slotted(2.0).value) == {"is": f"{name}.value", "self": slotted}
    assert parameters_of(Slotted.made) == {"is": f"{name}.made", "self": name}
    assert parameters_of(Plain(2.0).value) == {"is": f"{name}.value", "self": {"k": 2.0}}


def test_an_array_of_objects_is_no_parameter():
    """Its bytes are addresses, which differ from process to process."""
    numbers = np.array([1.0, 2.0])
    assert parameters_of(numbers) == {"array": digest_of_arrays({"": numbers})}
    with pytest.raises(ParameterError, match="one that holds a ndarray"):
        parameters_of(numbers.astype(object))


def test_a_parameter_may_be_none():
    assert parameters_of(Slotted(None)) == {"is": f"{__name__}.Slotted", "k": None}


def test_a_class_is_a_task_by_its_name():
    assert parameters_of(Code) == "verification.execution.metadata.Code"


class Kind(type):
    """A class of classes that is of no library."""


class Made(metaclass=Kind):
    k = 1.0


def test_what_a_class_defines_is_none_of_its_parameters():
    assert parameters_of(Made) == f"{__name__}.Made"


def test_a_module_of_a_user_that_a_task_holds_belongs_to_its_code(package):
    module = import_module("timed_code.other")
    assert code_of(partial(len, module)).modules == ("timed_code.other",)


def test_of_what_a_module_defines_only_that_module_is_noted(package):
    """What the task uses of other modules counts through the imports of its own."""
    (package / "user.py").write_text(
        "from timed_code import deep\n\n\ndef task(x):\n    return deep.f(x)\n"
    )
    user = import_module("timed_code.user")
    assert code_of(user.task).modules == ("timed_code.user",)
    before = code_of(user.task).digest
    (package / "deep.py").write_text("def f(x):\n    return x + 2\n")
    assert code_of(user.task).digest != before


def test_a_module_that_a_function_imports_under_another_name_is_noted(package):
    def task():
        from timed_code import deep as inner

        return inner

    reader = _TaskReader()
    reader.function(task)
    assert reader.modules == {"timed_code", "timed_code.deep"}


def test_modules_that_can_be_imported_are_noted_but_in_a_session_none_of_this_project(package):
    reader = _TaskReader()
    seen = []
    for name in (None, "math", "theory.arrays", "in_no_file", "theory.result", "timed_code.deep"):
        seen.append((reader.determines(name), reader.in_session, sorted(reader.modules)))
    noted = ["theory.arrays"]
    assert seen == [
        (True, False, []), (True, False, []), (True, False, noted), (False, True, noted),
        (True, True, noted), (True, True, [*noted, "timed_code.deep"]),
    ]  # fmt: skip


def test_the_digest_of_code_follows_the_package_of_each_module_and_the_files_of_a_user(
    package, monkeypatch
):
    asked = []
    monkeypatch.setattr(
        "verification.execution.task.digest_of_code",
        lambda *given, **options: asked.append((*given, options)) or "",
    )
    other = import_module("timed_code.other")
    code_of(sigma, other)
    modules = ("fronts.piecewise.sigma", "timed_code.other")
    assert asked == [(modules, {*SOURCES, "fronts", "timed_code"}, {"users": True})]


@pytest.mark.parametrize("wrap", [lru_cache, njit])
def test_functions_are_told_apart_by_what_is_inside_of_what_a_cache_or_numba_makes(wrap):
    def made(size):
        def task(c, size=size):
            return size * c

        return wrap(task)

    for content in (code_of, parameters_of):
        assert content(made(1.0)) == content(made(1.0)) != content(made(2.0))


@pytest.mark.parametrize(
    ("one", "same", "other"),
    [
        (str.upper, str.upper, str.lower),
        ([1.0].index, [1.0].index, [2.0].index),
        ([1.0].index, [1.0].index, [1.0].count),
    ],
)
def test_methods_of_builtin_types_are_told_apart_by_name_and_by_what_they_are_bound_to(
    one, same, other
):
    readers = [_TaskReader() for _ in range(3)]
    methods = (one, same, other)
    first, second, third = (
        reader.value(each, "the task") for reader, each in zip(readers, methods, strict=True)
    )
    assert first == second != third
    for reader in readers:  # they belong to no module
        assert (reader.modules, reader.in_session) == (set(), False)


@dataclass(frozen=True)
class Held:
    k: float


@dataclass(frozen=True)
class AlsoHeld:
    k: float


def test_objects_that_hold_the_same_are_told_apart_by_their_class():
    held, same, other, more = (
        _TaskReader().value(each, "the task")
        for each in (Held(1.0), Held(1.0), AlsoHeld(1.0), Held(2.0))
    )
    assert held == same
    assert len({held, other, more}) == 3


def test_functions_of_libraries_and_what_a_mapping_holds_are_told_apart_by_name():
    assert code_of(math.sqrt) != code_of(cmath.sqrt)
    assert code_of({"a": math.sqrt}) == code_of({"a": math.sqrt}) != code_of({"b": math.sqrt})
    assert parameters_of(partial(shape, 1)) == {"0": 1}


def test_everything_with_code_counts_that_a_task_holds_in_whatever_it_is():
    for held in ((shape, differences), [shape, differences], {"a": shape, "b": differences}):
        for task in (held, partial(parameters_of, held), SimpleNamespace(held=held)):
            modules = code_of(task).modules
            assert {shape.__module__, differences.__module__} <= {*modules}


def test_code_of_no_module_counts_by_itself(monkeypatch):
    """A function, and a class by its methods, that were typed into a session."""
    session = ModuleType("typed_here")
    monkeypatch.setitem(sys.modules, "typed_here", session)

    def typed(text):
        exec(text, vars(session))
        return vars(session)["x"]

    texts = [
        f"{head} return {value}"
        for head in (
            "def x():",
            "def x():\n def y():",
            "class x:\n def __call__(self):",
            "class x:\n def f(self):",
        )
        for value in ("1", "2", "a", "b", "lambda: 1", "lambda: 2")
    ]
    found = [code_of(typed(text)) for text in texts]
    assert {code.modules for code in found} == {()}
    assert len({code.digest for code in found}) == len(texts)
    assert code_of(typed("# one\ndef x():\n return 1")) == found[0]
    assert code_of(typed(texts[-1])()) == code_of(typed(texts[-1])())
    assert code_of(typed(texts[-1])()) != code_of(typed(texts[-2])())
    # It may use all of the project, which is therefore part of it.
    monkeypatch.setattr("verification.execution.task.digest_of_packages", lambda _: "another")
    assert code_of(typed(texts[0])) != found[0]


def test_what_differs_is_named_with_both_values_where_these_are_short():
    found = {"a": 1, "digest": "x", "long": "y" * 80, "short": "y" * 79, "same": 3.0}
    here = {"a": None, "digest": "z", "long": "w", "short": "w", "same": 3.0}
    assert differences(found, here) == (
        f"a: 1 there, None here; digest; long; short: {'y' * 79} there, w here"
    )
    inner = differences({"run": {"c": 1, "d": [2]}, "v": {}}, {"run": {"c": 2, "d": [2]}, "v": 3})
    assert inner == "run.c: 1 there, 2 here; v: {} there, 3 here"


def test_a_function_is_told_from_another_by_what_it_has_as_defaults_or_captured():
    """What a store holds of one must not be taken for results of the other."""

    def made(size, power, shift):
        def task(c, size=size, *, power=power):
            return float(size * c**power + shift)

        return task

    plain = made(2.0, 3.0, 0.5)
    assert parameters_of(plain) == parameters_of(made(2.0, 3.0, 0.5))
    for other in (made(4.0, 3.0, 0.5), made(2.0, 4.0, 0.5), made(2.0, 3.0, 4.0)):
        assert parameters_of(other) != parameters_of(plain)


def test_a_function_of_a_session_is_told_from_another_by_what_it_uses_there(monkeypatch):
    """In a notebook one cell is changed and another one run again."""
    session = ModuleType("typed_here")
    monkeypatch.setitem(sys.modules, "typed_here", session)
    cells = {
        "scale": "scale = 2.0",
        "chain": "from fronts import VdpChain; chain = VdpChain(a=4, b=0.5, c=0.6)",
        "deep": "def deep(c, power=2): return c**power",
        "helper": "def helper(c): return [deep(x) for x in [c]] if c else task(1)",
        "task": "def task(c): return (lambda: scale * helper(c) + chain.b)()",
        "other": "unused = 1; opened = open; log = [object()]",
    }

    def identity(**changed):
        for text in (cells | changed).values():
            exec(text, vars(session))
        return code_of(vars(session)["task"])

    known = [identity()]
    for changed in (
        {"scale": "scale = 3.0"},
        {"chain": cells["chain"].replace("0.6", "0.7")},
        {"deep": "def deep(c, power=3): return c**power"},
        {"deep": "def deep(c, power=2): return c*power"},
        {"helper": cells["helper"].replace("task(1)", "task(2)")},
    ):
        known.append(identity(**changed))
        assert known[-1] not in known[:-1]
    assert identity(other="unused = 2") == known[0]


def test_a_method_of_a_session_is_told_from_another_by_what_its_class_uses_there(monkeypatch):
    session = ModuleType("typed_here")
    monkeypatch.setitem(sys.modules, "typed_here", session)
    text = "class Scaled:\n    def value(self, c): return scale * c"

    def used(scale):
        exec(f"scale = {scale}\n{text}", vars(session))
        return code_of(session.Scaled().value)

    assert used(2.0) == used(2.0) != used(3.0)


def test_an_object_that_can_be_called_is_told_from_another_by_its_attributes():
    class Task:
        def __init__(self, size):
            self.size = size

        def __call__(self, c):
            return self.size * c

        def twice(self, c):
            return 2.0 * self(c)

    for called in (lambda task: task, lambda task: task.twice, lambda task: partial(task, 1.0)):
        one, same, other = (parameters_of(called(Task(size))) for size in (1.0, 1.0, 3.0))
        assert one == same != other
        assert code_of(called(Task(1.0))).modules == (__name__,)
    with pytest.raises(ParameterError, match="one that holds a object"):
        parameters_of(Task(object()))


@pytest.mark.parametrize(
    ("given", "use", "changed"),
    [
        ("class K:\n k = 1.0", "K.k", ("1.0", "2.0")),
        ("class B:\n def m(self): return 1\nclass K(B): pass", "K().m()", ("return 1", "return 2")),
        ("class K:\n @staticmethod\n def m(): return 1", "K.m()", ("return 1", "return 2")),
        ("class K:\n @property\n def m(self): return 1", "K().m", ("return 1", "return 2")),
        ("class K:\n def m(self, c=1): return c", "K().m()", ("c=1", "c=2")),
        ("class K:\n def m(self): return h()\ndef h(): return 1", "K().m()", ("turn 1", "turn 2")),
        ("class K:\n def m(self): return L()\nclass L:\n k = 1\n def n(self): return K()",
         "K().m().k", ("k = 1", "k = 2")),
        ("from types import SimpleNamespace as N\nk = N(k=1)", "k.k", ("k=1", "k=2")),
        ("k = {1, 2}", "len(k)", ("1,", "1, 3,")),
        ("k = [{'a': 1}]", "k[0]", ("1}", "2}")),
        ("class K:\n __slots__ = 'k'\nK0 = K(); K0.k = 1", "K0.k", ("k = 1", "k = 2")),
        ("from fractions import Fraction\nk = Fraction(1, 2)", "k * c", ("1, 2", "1, 3")),
        ("from scipy.interpolate import CubicSpline\nk = CubicSpline([0, 1, 2, 3], [0, 1, 0, 1])",
         "k(c)", ("0, 1]", "0, 2]")),
        ("from scipy.sparse import csr_array\nk = csr_array([[1.0, 2.0]])", "k", ("1.0,", "3.0,")),
        ("from numpy.polynomial import Polynomial\nk = Polynomial([1.0, 2.0])", "k(c)",
         ("1.0,", "1.00000000001,")),
        ("from collections import deque\nimport numpy as np\nk = deque([np.arange(5000)])", "k[0]",
         ("5000)", "5000)**2")),
        ("import sympy\nk = sympy.lambdify('x', '2*x')", "k(c)", ("2*x", "3*x")),
        ("class K(float): pass\nk = K(1.5)", "k", ("1.5", "2.5")),
        ("k = {'a': 1}.keys()", "c in k", ("'a'", "'b'")),
        ("k = {'a': 1}.get", "k('a')", ("1}", "2}")),
        ("def K(c): return c\ndef k(f): return f", "k(K)(c)", ("return f", "return f(1)")),
        ("from enum import Enum\nclass K(Enum):\n a = 1\n b = 2\nk = K.a", "k", ("K.a", "K.b")),
        ("from enum import Enum\nclass K(Enum):\n a = 1\nk = K.a", "k.value", ("a = 1", "a = 2")),
        ("from enum import Enum\nclass K(Enum):\n a = 1\n b = 2\nk = {K.a, K.b}\nz = K.a", "k, z",
         ("z = K.a", "z = K.b")),
        ("import functools\ndef f(c, k): return c\nk = functools.partial(f, k=1)", "k(c)",
         ("k=1", "k=2")),
        ("from functools import lru_cache\n@lru_cache\ndef k(c): return 1", "k(c)",
         ("turn 1", "turn 2")),
        ("class K:\n def __call__(self, c): return 1\nk = K()", "k(c)", ("turn 1", "turn 2")),
        ("k = {'a', 'b'}", "[c in {'a', 'b'} for c in k]", ("= {'a'", "= {'c'")),
        ("import math as k", "k.sqrt(c)", ("math", "cmath")),
        ("import math, cmath\nk = [math]", "k[0].sqrt(c)", ("[math", "[cmath")),
    ],
)  # fmt: skip
def test_what_a_session_defines_is_seen_to_change(given, use, changed, monkeypatch):
    session = ModuleType("typed_here")
    monkeypatch.setitem(sys.modules, "typed_here", session)
    found = []
    for text in (given, given, given.replace(*changed)):
        exec(f"{text}\ndef task(c): return {use}", vars(session))
        found.append(code_of(session.task))
    assert found[0] == found[1] != found[2]


def test_what_libraries_define_is_not_read(monkeypatch):
    """Their versions are recorded; some of their objects refer to themselves or to machine code."""
    session = ModuleType("typed_here")
    monkeypatch.setitem(sys.modules, "typed_here", session)
    exec(
        "import math, numpy as np\nfrom scipy.stats import norm\n"
        "from scipy.optimize import brentq\nmixed = np.array([1, None])\n"
        "def task(c): return math.sin(c), np.cos(c), norm.cdf(c), brentq, mixed",
        vars(session),
    )
    assert parameters_of(session.task) == "typed_here.task"
    for task in (session.task, session.norm.cdf, partial(math.pow, 2.0), np.sin):
        assert code_of(task).modules == ()
        assert code_of(task) == code_of(task)


def test_what_a_function_of_a_library_holds_is_not_read_since_it_changes_with_its_use():
    of_a_library = pkgutil.iter_importer_modules  # remembers the types that it was called with
    before = code_of(of_a_library)
    of_a_library.dispatch(type("Fresh", (), {}))
    assert code_of(of_a_library) == before


def test_a_session_may_use_this_project_as_a_module_and_by_its_names(monkeypatch):
    session = ModuleType("typed_here")
    monkeypatch.setitem(sys.modules, "typed_here", session)
    exec(
        "import fronts as fr\nfrom fronts import sigma, measure_front\nfrom theory import chains\n"
        "def task(c): return fr.VdpChain, sigma(c, 1.0), measure_front, chains",
        vars(session),
    )
    assert code_of(session.task) == code_of(session.task)
    assert code_of(session.task).modules == ()  # in a session all of the project counts
    assert code_of(partial(session.sigma, 0.3)).modules == ("fronts.piecewise.sigma",)


def test_a_decorated_function_is_told_from_another_by_what_decorates_it():
    def scaled(factor):
        def decorate(task):
            @wraps(task)
            def called(c):
                return factor * task(c)

            return called

        return decorate

    def task(c):
        return c

    one, same, other = (parameters_of(scaled(factor)(task)) for factor in (2.0, 2.0, 3.0))
    assert one == same != other


@pytest.mark.parametrize("inside", [False, True])
@pytest.mark.parametrize(
    "use", ["from {} import inner", "import {} as outer", "from folder_{} import part as outer"]
)
def test_a_changed_file_that_a_script_imports_is_seen_at_any_depth(
    use, inside, tmp_path, monkeypatch
):
    monkeypatch.syspath_prepend(tmp_path)
    names = [f"of_a_user_{inside}_{abs(hash(use))}_{i}" for i in range(2)]
    folder = tmp_path / f"folder_{names[0]}"
    folder.mkdir()
    (folder / "__init__.py").touch()
    for file in (tmp_path / f"{names[0]}.py", folder / "part.py"):
        file.write_text(f"from {names[1]} import inner\n")
    script = ModuleType("typed_here")
    monkeypatch.setitem(sys.modules, "typed_here", script)
    digests = []
    for i, text in enumerate(("1", "2", "2 # one")):
        inner = tmp_path / f"{names[1]}.py"
        inner.write_text(f"def inner(): return {text}\n")
        os.utime(inner, (i, i))  # two files written within a tick of the clock have the same time
        imported = use.format(names[0])
        head = f"def task(c):\n {imported}\n" if inside else f"{imported}\ndef task(c):\n"
        exec(f"{head} return inner if c else outer.inner", vars(script))
        digests.append(code_of(script.task).digest)
    assert digests[0] != digests[1] == digests[2]


def test_a_module_that_imports_computed_names_imports_its_whole_package(tmp_path, monkeypatch):
    """But for its tests."""
    monkeypatch.syspath_prepend(tmp_path)
    package = tmp_path / "found_by_name"
    (package / "inner").mkdir(parents=True)
    for name in ("__init__", "one", "test_one", "inner/__init__", "inner/two"):
        (package / f"{name}.py").touch()
    (package / "one.py").write_text("import importlib\nimportlib.import_module(name)\n")
    expected = ["found_by_name"] + [f"found_by_name.{each}" for each in ("inner", "inner.two")]
    found = closure("found_by_name.one", ["found_by_name"])
    assert list(found) == [*expected, "found_by_name.one"]
    assert list(closure("found_by_name.inner.two", ["found_by_name"])) == expected


def test_dots_of_an_import_lead_from_the_package_that_a_file_is_in(tmp_path, monkeypatch):
    """Of a package that is the package itself, and of a module the one above it."""
    monkeypatch.syspath_prepend(tmp_path)
    package = tmp_path / "found_by_dots"
    (package / "inner").mkdir(parents=True)
    imports = {
        "__init__": "from .a import f", "a": "from . import b", "b": "from .inner import f",
        "inner/__init__": "from .c import f", "inner/c": "from ..d import f", "d": "",
    }  # fmt: skip
    for name, text in imports.items():
        (package / f"{name}.py").write_text(text)
    followed = closure("found_by_dots", ["found_by_dots"])
    assert {path.relative_to(package) for path in followed.values()} == {
        Path(f"{name}.py") for name in imports
    }


def test_a_digest_is_known_as_long_as_every_package_is_found_where_it_was():
    homes = {name: source_of(name) for name in ("json", "bisect")}
    moved = homes | {"bisect": source_of("json")}
    for found, known in ((homes, True), (moved, False)):
        assert digest._Known(digest="", homes=found, places={}).holds() is known


def test_imports_are_followed_through_files_of_a_user_where_these_count(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "of_a_user.py").write_text("import numpy, verification, theory.arrays, beside_it\n")
    (tmp_path / "beside_it.py").touch()
    assert closure("of_a_user", ["theory"]) == {}
    followed = closure("of_a_user", ["theory"], users=True)
    assert list(followed) == ["beside_it", "of_a_user", "theory", "theory.arrays"]


def test_the_processor_is_that_of_python_where_the_system_does_not_name_it(
    monkeypatch,
):
    monkeypatch.setattr(metadata, "Path", lambda _: SimpleNamespace(is_file=lambda: False))
    for said, shown in (("arm", "arm"), ("", "unknown")):
        monkeypatch.setattr("platform.processor", lambda said=said: said)
        assert metadata._processor.__wrapped__() == shown


def test_code_whose_file_is_gone_is_known_by_what_is_executed(monkeypatch):
    module = ModuleType("code_that_is_gone")
    module.__file__ = "/nowhere/code_that_is_gone.py"
    monkeypatch.setitem(sys.modules, module.__name__, module)
    exec("def f(x):\n    return x + 1", vars(module))
    one = code_of(module.f)
    exec("def f(x):\n    return x + 2", vars(module))
    assert code_of(module.f) != one


def test_code_of_no_module_counts_with_all_of_the_project(monkeypatch):
    """As a function that SymPy makes, which is in no module whose imports could be read."""
    nowhere = {}
    exec("def f(x):\n    return x + 1", nowhere)
    one = code_of(nowhere["f"])
    monkeypatch.setattr("verification.execution.task.digest_of_packages", lambda _: "changed")
    assert code_of(nowhere["f"]) != one
