"""The command line: a thin table from a subcommand to one function of the toolkit."""
