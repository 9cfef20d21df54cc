"""Held-out motions of the machines, replayed behind their own controllers by diagnosed models."""
