"""Logs of flights: kept, listed, sent and streamed."""
