"""How fast the programs are, each figure against its budget."""
