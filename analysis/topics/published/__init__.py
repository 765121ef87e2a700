"""The published table: set-ups above, beside and diagonal to a plate, every value enclosed and known to four digits."""
