"""What reads a machine: encoders, clocks, an IMU."""
