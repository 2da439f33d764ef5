"""The command ``fronts``, also as ``python -m fronts``."""

import sys


def main() -> int:
    """Run the command; an interruption during its import ends it like one while it runs."""
    try:
        from fronts.cli import main as run
    except KeyboardInterrupt:
        print("fronts: interrupted; nothing had begun.", file=sys.stderr)
        return 130
    return run()


if __name__ == "__main__":
    sys.exit(main())
