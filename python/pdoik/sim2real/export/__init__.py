"""The improved model in the user's formats, URDF and MJCF, as far as these have words for it."""
