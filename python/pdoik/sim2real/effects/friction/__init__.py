"""What rubs in a joint."""
