"""Compiled steppers: one method a file."""
