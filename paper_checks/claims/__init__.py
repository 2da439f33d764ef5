"""One module per group of claims. A module added here is included in the next report."""
