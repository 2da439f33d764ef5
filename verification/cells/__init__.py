"""The states of one isolated oscillator (Fig. 2): ``cell``, for every model.

``result`` defines the results. ``friction_cycles`` finds one cycle by shooting at one tolerance,
``friction`` compares tolerances and finds where cycles end, ``diagram`` follows them over the belt
velocity; ``vdp`` finds both cycles of (8) and of (43).
"""
