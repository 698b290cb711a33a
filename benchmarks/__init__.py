"""Side-by-side speed and accuracy, one script a subject, each printing JSON."""
