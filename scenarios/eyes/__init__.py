"""How well the detector of the pad sees: rendered frames drawn over ranges, angles and light, compared with truth."""
