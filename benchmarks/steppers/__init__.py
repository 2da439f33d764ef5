"""Steppers used only in benchmarks, for comparison with those of ``verification.steppers``."""
