"""Other ways to name a fault, and our own with single stages switched off, on the same worlds."""
