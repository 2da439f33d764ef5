"""Maps over parameters.

``sweep`` hands points to workers, ``journal`` keeps what is done, ``table`` holds the result,
``boundary`` bisects where the outcome changes.
"""
