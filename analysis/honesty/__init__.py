"""The league of honesty: how often the errors that every method states hold, in random scenes of every kind."""
