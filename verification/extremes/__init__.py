"""Every quantity over all decades of its parameters, each value held against another method.

A module of this package that exposes ``QUANTITIES`` adds its quantities to the table; a model is
added by adding a file.
"""
