"""Experiments: vehicles on roads, runs, scores and reports."""
