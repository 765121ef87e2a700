"""Stored answers and the tables, statistics and symmetries that are computed from them."""
