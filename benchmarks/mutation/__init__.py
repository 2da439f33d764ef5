"""Whether the tests notice a wrong formula: one sign, factor or index changed at a time."""
