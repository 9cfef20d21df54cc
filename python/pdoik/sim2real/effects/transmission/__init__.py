"""What is between a motor and its link: rotors, gears, springs, play."""
