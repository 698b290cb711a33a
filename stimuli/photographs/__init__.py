"""The user's photographs of one scene under several lights: read, checked, combined."""
