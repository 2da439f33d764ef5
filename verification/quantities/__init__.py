"""The registry: what can be computed, by what, over which ranges, against what.

A module of this package that exposes ``QUANTITIES`` adds its quantities to the stability table.
"""
