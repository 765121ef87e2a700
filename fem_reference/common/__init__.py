"""Code that all folders of the reference use: limits, and names of the stages for messages."""
