"""What stands in the sets that show a scene."""
