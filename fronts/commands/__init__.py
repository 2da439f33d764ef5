"""One module per subcommand, with a function of the same name that returns an ``Answer``."""
