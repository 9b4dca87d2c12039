"""What attackers try against the links of a companion, and what it should come to."""
