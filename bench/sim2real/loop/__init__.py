"""Closing the loop: record, diagnose, feed the model forward, run again."""
