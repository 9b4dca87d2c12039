"""The mission protocol: plans uploaded, kept and downloaded."""
