"""Computes answers: the jobs, the stages that run the model and the reference, and the keys of what they store."""
