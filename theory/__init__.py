"""What the paper asserts, as numbers: closed forms, roots, sums, branches, profiles."""
