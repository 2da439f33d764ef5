"""The piecewise-linear chain (44) (Figs. 16-18), advanced exactly from switching to switching.

``simulation`` measures a front; it advances ``chain`` within ``window`` from one ``crossing`` to
the next; ``verdict`` and ``run`` classify and report the motion.
"""
