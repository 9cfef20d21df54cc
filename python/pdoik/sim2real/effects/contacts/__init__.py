"""What touches a machine."""
