"""The equations on one mesh: potentials and fluxes, and the energies that bound the Maxwell matrix."""
