"""Whether what is told can be believed: stamps, contradictions, courses and heights."""
