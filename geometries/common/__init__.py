"""Shared by all packages: errors, files, TOML tables, and where programs and results are installed."""
