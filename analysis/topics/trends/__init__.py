"""The trends of a study: every value and every instruction count over the commits, and which changes are alarms."""
