"""Steppers that are here to be measured beside those of ``verification.steppers``."""
