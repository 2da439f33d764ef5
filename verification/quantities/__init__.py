"""The registry of quantities: what is computed, by what method, in what range, how checked.

A module of this package that exposes ``QUANTITIES`` adds quantities; ``quantity`` contains the
contract and explains how to write one.
"""
