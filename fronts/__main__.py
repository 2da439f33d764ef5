"""The command ``fronts``, also as ``python -m fronts``."""

import sys


def main() -> int:
    """Run the command; interrupted while it is still imported, it ends like one that runs."""
    try:
        from fronts.cli import main as run
    except KeyboardInterrupt:
        print("fronts: interrupted; nothing had begun.", file=sys.stderr)
        return 130
    return run()


if __name__ == "__main__":
    sys.exit(main())
