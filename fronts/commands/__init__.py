"""One subcommand a file: ``configure`` its options, ``run`` it, return an ``Answer``."""
