"""Any polynomial cell: average, cycles, second order, and the front that follows."""
