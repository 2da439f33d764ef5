"""Velocities of travelling fronts, measured on running chains."""
