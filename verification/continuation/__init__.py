"""Solutions of F(u, c) = 0 and their branches in c: ``newton`` solves, ``branch`` follows.

Breathers, orbits and fronts are such solutions; each provides its own F.
"""
