"""One file for each stimulus set; each offers `make(folder, ...)`."""
