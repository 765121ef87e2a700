"""Solves the field problem on one mesh: potentials, fluxes, and the energies of both, which bound the Maxwell matrix."""
