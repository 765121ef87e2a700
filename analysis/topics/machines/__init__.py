"""The model's error on machines: what other conductors around sensor and target add to it, in named parts."""
