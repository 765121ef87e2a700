"""The reference against what is known: capacitances, properties, run time against error; a chapter of the report."""
