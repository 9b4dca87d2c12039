"""The source report's cases flown and shown as it did."""
