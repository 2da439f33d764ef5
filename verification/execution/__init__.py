"""How computations are run and stored; used by all other folders instead of code of their own.

``files``
    Writing files completely or not at all, with one writer per file.
``digest``, ``metadata``, ``record``
    Which code a result depends on; the provenance of a stored result; storing and reading a result.
``pool``, ``interruption``, ``progress``
    Worker processes, interrupts and SIGTERM, progress display.
``store``
    The finished results, from which an interrupted computation continues.
``sweep``, ``table``
    A function evaluated at many points, and the resulting table.
``discovery``
    What the modules of a package expose.
``compiled``
    numba, with compiled code that matches the present sources.
"""
