"""The output of the command: documents on standard output, and files."""
