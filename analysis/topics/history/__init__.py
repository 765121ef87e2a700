"""The nights of a study: what moved between two results, the record of the nights, and their page."""
