"""Studies: the files in this folder, their reader, and the families of set-ups that they name."""
