"""Whether the tests notice a wrong formula or a wrong judgement: one thing changed at a time."""
