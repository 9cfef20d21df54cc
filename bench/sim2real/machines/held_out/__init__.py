"""What a diagnosis leaves of held-out torques, beside what the true machine's own law leaves."""
