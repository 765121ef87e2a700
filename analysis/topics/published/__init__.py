"""The published table: set-ups above, beside and diagonal to a plate, with bounds and four digits for every value."""
