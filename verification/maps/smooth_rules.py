"""Rules of a general smooth chain, to follow."""
