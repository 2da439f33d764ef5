"""Compiled steppers, one method per file."""
