"""What leaves the store: tables, Psych-DS folders, bundles that analyse to the same numbers."""
