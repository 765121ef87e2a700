"""One study from its file to its report: plans it, runs it, and writes the table and the pages."""
