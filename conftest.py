"""Which modules pytest leaves out, no search for garbage, time limits, and who shares a process.

Left out are modules of an optional extra that is not installed here. Collecting makes millions of
objects that live to the end: looking through them took a third of it, and time in every test after.
Where several processes test, each takes whole files; those that ask for the derivations of the
paper go to one of them, since deriving and checking all takes ten seconds a process.
"""

import gc
from importlib.util import find_spec
from pathlib import PurePath
from typing import Any

import pytest

collect_ignore = (
    [] if find_spec("panel") else ["fronts/explore/page.py", "fronts/explore/pictures.py"]
)


def pytest_collection() -> None:
    """Search for no garbage while modules are imported and tests are made."""
    gc.disable()


def pytest_collection_finish() -> None:
    """Search again, though less often, and leave out what has been collected."""
    gc.freeze()
    gc.set_threshold(100_000, 20, 100)  # a twentieth of the time of computer algebra
    gc.enable()


@pytest.fixture
def unhurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten times the time limits of values and of references: a machine may be slow, or shared."""
    from verification.quantities import judging
    from verification.references import pace

    monkeypatch.setattr(pace, "MAX_SECONDS", 10.0 * pace.MAX_SECONDS)
    monkeypatch.setattr(judging, "SLOWNESS", 10.0)


DERIVING = (
    "test_behaviour",
    "test_derivations",
    "test_errata",
    "test_report_of_the_paper",
    "test_transcription",
)
"""How the names of the files begin whose tests ask for the derivations of the paper."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Hand out whole files, those that derive together."""
    if config.getoption("dist") != "loadfile":
        return None
    from xdist.scheduler import LoadFileScheduling

    class Sharing(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file = nodeid.partition("::")[0]
            return DERIVING[0] if PurePath(file).name.startswith(DERIVING) else file

    return Sharing(config, log)
