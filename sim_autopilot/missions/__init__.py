"""Missions, fences and rally points: uploaded, kept and flown."""
