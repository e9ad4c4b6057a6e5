"""What the world is: worlds, scenarios, and where they come from."""
