"""What the built-in tasks draw beyond their scene files, and the generator of random test scenes."""
