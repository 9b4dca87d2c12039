"""The vehicle: where it is, where it will be, where its pad is, and how it drives."""
