"""The front of the averaged chain, Eqs. (43)-(54), its limits, and its speed at strong coupling."""
