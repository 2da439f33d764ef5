"""Which modules pytest leaves out: those of an optional extra that is not installed here."""

from importlib.util import find_spec

collect_ignore = (
    [] if find_spec("panel") else ["fronts/explore/page.py", "fronts/explore/pictures.py"]
)
