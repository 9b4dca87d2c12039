"""Arming, failsafes and injected failures."""
