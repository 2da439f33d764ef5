"""Rendering of a run: the page and its parts, pictures, tables for the terminal."""
