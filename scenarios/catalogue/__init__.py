"""The scenarios by name, as TOML files, and how they are loaded."""
