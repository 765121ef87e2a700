"""Experiment VII, in company: what a machine around the sensor, and the hand's connection to the ground, make of a reading."""
