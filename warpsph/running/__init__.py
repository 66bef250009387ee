"""A run around its solver: what is due when, what ends it, and what goes on from there."""
