"""The documentation as a site: Sphinx and Doxygen."""
