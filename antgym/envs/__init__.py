"""A paid trial as a Gymnasium environment."""
