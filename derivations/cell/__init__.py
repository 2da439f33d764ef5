"""Any polynomial cell: average, cycles, second order, and the resulting front."""
