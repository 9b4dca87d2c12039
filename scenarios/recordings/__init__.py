"""The recordings of runs: written while they last, and replayed."""
