"""Runs and campaigns as figures and pages."""
