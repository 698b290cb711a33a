"""Image in, image or estimate out: plain functions on arrays, and the words shared by all rooms."""
