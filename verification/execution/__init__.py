"""How computations are run and stored; what all other folders use instead of their own.

``files``
    Writing files whole or not at all; one writer a file.
``digest``, ``metadata``, ``record``
    Which code a result depends on; what a stored result says of itself; storing and reading one.
``pool``, ``interruption``, ``progress``
    Worker processes, interrupts and SIGTERM, what is shown meanwhile.
``store``
    The finished results, from which an interrupted computation goes on.
``sweep``, ``table``
    A function at many points, and the table that comes of it.
``discovery``
    What the modules of a package expose.
``compiled``
    numba, with compiled code that belongs to the sources as they are.
"""
