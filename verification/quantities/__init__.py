"""The registry: what can be computed, by what, over which ranges, against what.

A module of this package that exposes ``QUANTITIES`` adds quantities; ``quantity`` has the contract
and says how to write one.
"""
