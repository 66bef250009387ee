"""Memory: what a run will need and what there is, told before it is taken; and when it runs out all the same."""
