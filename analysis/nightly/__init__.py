"""Runs a study night by night, on this machine or on a cluster."""
