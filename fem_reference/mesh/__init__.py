"""From bodies to a tetrahedral mesh: geometry, sizes of the cells, quarter-point elements."""
