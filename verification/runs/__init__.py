"""Direct runs of the chains, with their error by comparison with runs at other tolerances."""
