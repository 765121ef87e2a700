# Packages for the browser: the toolchain of emscripten looks for none of this machine's, as its libraries are for another processor.
# The packages of headers are used by links in a folder of their own, so that no other header of this machine is found. TBB and
# meshoptimizer, which are libraries, have serial forms in `serial`.
set(browser_headers ${PROJECT_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${browser_headers})
foreach(name boost eigen3/Eigen fmt nlohmann toml++)
  cmake_path(GET name FILENAME link)
  file(CREATE_LINK /usr/include/${name} ${browser_headers}/${link} SYMBOLIC)
endforeach()

# Makes find_package(name) find a target whose headers lie in `folder`.
function(provide_package name target folder)
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} INTERFACE ${folder})
  file(WRITE ${CMAKE_FIND_PACKAGE_REDIRECTS_DIR}/${name}Config.cmake "")
  file(WRITE ${CMAKE_FIND_PACKAGE_REDIRECTS_DIR}/${name}ConfigVersion.cmake "set(PACKAGE_VERSION_COMPATIBLE TRUE)\n")
endfunction()

provide_package(Boost Boost::headers ${browser_headers})
provide_package(Eigen3 Eigen3::Eigen ${browser_headers})
provide_package(fmt fmt::fmt ${browser_headers})
target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY)
provide_package(nlohmann_json nlohmann_json::nlohmann_json ${browser_headers})
provide_package(tomlplusplus tomlplusplus::tomlplusplus ${browser_headers})
provide_package(TBB TBB::tbb ${CMAKE_CURRENT_LIST_DIR}/serial)
provide_package(meshoptimizer meshoptimizer::meshoptimizer ${CMAKE_CURRENT_LIST_DIR}/serial)
