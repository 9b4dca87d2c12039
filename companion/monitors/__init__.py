"""What the companion notices beside its estimate: contact, contradictions, surprises, a wrong height or heading."""
