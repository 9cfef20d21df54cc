"""What turns a command into torque: delays, lags, gains, limits."""
