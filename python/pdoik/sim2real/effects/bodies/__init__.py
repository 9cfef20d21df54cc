"""Bodies and where they are: masses, loads, geometry, which way is down."""
