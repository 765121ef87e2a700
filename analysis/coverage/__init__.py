"""From which distance a probe is noticed, at every place around a machine."""
