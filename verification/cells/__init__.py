"""What one oscillator alone can do (Fig. 2): ``cell``, of either model.

Its answer is in ``result``. ``friction_cycles`` shoots for one cycle at one tolerance, ``friction``
compares tolerances and finds where cycles end, ``diagram`` follows them over the belt velocity;
``vdp`` finds both cycles of (8), and those of (43).
"""
