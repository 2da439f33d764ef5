"""Periodic orbits of one oscillator, found and followed numerically."""
