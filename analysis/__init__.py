"""Runs studies, holds the model against the field reference, and reports.

A study file becomes jobs (`study.workflow`), jobs store answers (`pipeline`, `results.store`), answers become rows
(`results.table`), and rows become pages (`study.report`, with the parts of `report` and the sections of `topics`).
"""
