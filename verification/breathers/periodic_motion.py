"""Analysis of one period from its samples: first harmonics and largest displacements."""

from __future__ import annotations

import math

import numpy as np

from theory.arrays import ComplexArray, FloatArray

SAMPLES = 64
"""Samples per period for harmonics and amplitudes."""
_FINE = 2048
_NEWTON = 3


def first_harmonics(samples: FloatArray) -> ComplexArray:
    """Return h_n of y_n = Im(h_n e^{iωt}) + …, shape (N,), from one period, shape (M, N).

    Examples
    --------
    >>> phase = 2.0 * np.pi * np.arange(8) / 8
    >>> np.abs(first_harmonics(np.sin(phase)[:, None])).round(12).tolist()
    [1.0]
    """
    spectrum = np.fft.rfft(samples, axis=0) / len(samples)
    harmonics: ComplexArray = 2j * spectrum[1]  # h/(2i) at +ω
    return harmonics


def largest_displacements(samples: FloatArray) -> FloatArray:
    """Return max |y_n(t)|, shape (N,), of trigonometric interpolants of a period, shape (M, N).

    Newton's method on the derivative, started from the largest of many values.

    Examples
    --------
    >>> phase = 2.0 * np.pi * np.arange(16) / 16
    >>> largest_displacements(np.sin(phase + 0.123)[:, None]).round(15).tolist()
    [1.0]
    """
    spectrum = np.fft.rfft(samples, axis=0)[: (len(samples) + 1) // 2] / len(samples)
    orders = np.arange(len(spectrum))[:, None]
    weights = np.where(orders == 0, 1.0, 2.0) * spectrum
    peak = np.abs(np.fft.irfft(spectrum * _FINE, n=_FINE, axis=0)).argmax(axis=0)
    spacing = 2.0 * math.pi / _FINE
    phase = spacing * peak

    def derivative(k: int) -> FloatArray:
        terms = weights * (1j * orders) ** k * np.exp(1j * orders * phase)
        return np.asarray(terms.sum(axis=0).real)

    for _ in range(_NEWTON):
        slope, second_derivative = derivative(1), derivative(2)
        step = np.divide(
            slope, second_derivative, out=np.zeros_like(slope), where=second_derivative != 0.0
        )
        phase = phase - np.clip(step, -spacing, spacing)
    return np.abs(derivative(0))
