"""Which modules pytest leaves out, and no search for garbage in what it has collected.

Left out are modules of an optional extra that is not installed here. Collecting makes millions of
objects that live to the end: looking through them took a third of it, and time in every test after.
"""

import gc
from importlib.util import find_spec

collect_ignore = (
    [] if find_spec("panel") else ["fronts/explore/page.py", "fronts/explore/pictures.py"]
)


def pytest_collection() -> None:
    """Search for no garbage while modules are imported and tests are made."""
    gc.disable()


def pytest_collection_finish() -> None:
    """Search again, and leave out what has been collected."""
    gc.freeze()
    gc.enable()
