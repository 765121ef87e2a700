"""The nights of a study: the difference between two results, the record of the nights, and their page."""
