# `cpack` in the build folder makes build/debian/fringe_VERSION_ARCHITECTURE.deb.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME fringe)
# The package has no maintainer: whoever distributes it names one, cmake -DFRINGE_MAINTAINER="Name <address>".
set(FRINGE_MAINTAINER "nobody, not maintained <nobody@localhost>" CACHE STRING "Maintainer of the Debian package")
set(CPACK_PACKAGE_CONTACT "${FRINGE_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "capacitance of proximity sensors, by a fast model and by finite elements")
set(CPACK_PACKAGE_DESCRIPTION
"What a capacitive proximity sensor feels of the objects around it: a model
that integrates over the triangles of a scene, boundary elements, and a
reference by finite elements with proven error bounds, compared in reports.
.
The C++ library with its headers, the command fringe, a Python module of the
same name, and the commands fringe-reference, fringe-analysis and
fringe-geometries.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/debian)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
math(EXPR FRINGE_NEXT_PYTHON "${Python_VERSION_MINOR} + 1")
# The module is built for one version of Python, whose number its file bears.
set(CPACK_DEBIAN_PACKAGE_DEPENDS
  "python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3 (<< ${Python_VERSION_MAJOR}.${FRINGE_NEXT_PYTHON}~), python3-numpy")
# The model does without the field solver, the reports and the compiler.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS
  "gcc, libc6-dev, openmpi-bin, python3-dolfinx, python3-gmsh, python3-jinja2, python3-meshio, python3-plotly, python3-psutil, python3-scipy, python3-tomli-w, python3-tqdm")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
  "g++, libeigen3-dev, libfmt-dev, libmeshoptimizer-dev, libsleef-dev, libtbb-dev, libtomlplusplus-dev, pkg-config, snakemake")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/postinst ${CMAKE_CURRENT_LIST_DIR}/prerm)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
