"""``python -m fronts`` is the same as ``fronts``."""

import sys

from fronts.cli import main

sys.exit(main())
