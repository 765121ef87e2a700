"""One package for each question that a report answers, with its data, its computation and its section."""
