"""The golden file: answers, stated errors and times of a fixed list of cases, which a restructured solver has to give again."""
