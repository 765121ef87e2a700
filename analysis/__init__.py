"""Run a study, hold the model against the field reference, report.

study → a job for every case and stage (`workflow`) → stored answers (`store`) → rows (`table`) → report (`report`).
"""
