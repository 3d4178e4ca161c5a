# Debian packages by CPack, one per installation component. Used by scripts/package.sh.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME byre)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "") # set per package
set(CPACK_PACKAGE_CONTACT "byre maintainers <maintainers@byre.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
    WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON) # requires the same version, see CPACK_COMPONENT_<component>_DEPENDS below
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# Documents that Debian policy requires in every package.
file(READ ${CMAKE_CURRENT_SOURCE_DIR}/LICENSE license)
string(REGEX MATCH "Copyright \\(c\\) ([^\n]*)" found "${license}")
set(byre_copyright ${CMAKE_MATCH_1})
string(REGEX REPLACE ".*Copyright \\(c\\) [^\n]*\n\n" "" byre_license "${license}")
string(STRIP "${byre_license}" byre_license)
string(REPLACE "\n\n" "\n.\n" byre_license "${byre_license}")
string(REPLACE "\n" "\n " byre_license " ${byre_license}")
string(TIMESTAMP byre_date "%a, %d %b %Y %H:%M:%S +0000" UTC) # SOURCE_DATE_EPOCH if set
set(byre_debian_dir ${CMAKE_CURRENT_BINARY_DIR}/debian)
configure_file(cmake/debian/copyright.in ${byre_debian_dir}/copyright @ONLY)
configure_file(cmake/debian/changelog.in ${byre_debian_dir}/changelog @ONLY)
find_program(BYRE_GZIP gzip DOC "gzip, compression of the packages' change log")
if(BYRE_GZIP)
  execute_process(COMMAND ${BYRE_GZIP} -9nkf ${byre_debian_dir}/changelog)
endif()

# Package of one component. PACKAGE: its name; SECTION: Debian section; NEEDS: components; DEPENDS and RECOMMENDS:
# packages in addition to the shared libraries found in it. Maintainer scripts are in cmake/debian/<component>.
function(byre_add_package component)
  cmake_parse_arguments(PARSE_ARGV 1 debian "" "PACKAGE;SECTION;SUMMARY;DESCRIPTION;DEPENDS;RECOMMENDS;ARCHITECTURE" "NEEDS")
  string(TOUPPER ${component} upper)
  file(GLOB scripts CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/cmake/debian/${component}/*)
  install(FILES ${byre_debian_dir}/copyright DESTINATION share/doc/${debian_PACKAGE} COMPONENT ${component}
          EXCLUDE_FROM_ALL)
  install(FILES ${byre_debian_dir}/changelog.gz DESTINATION share/doc/${debian_PACKAGE} RENAME changelog.Debian.gz
          COMPONENT ${component} EXCLUDE_FROM_ALL OPTIONAL)
  if(component STREQUAL program)
    install(FILES ${CMAKE_CURRENT_SOURCE_DIR}/README.md DESTINATION share/doc/${debian_PACKAGE} COMPONENT program
            EXCLUDE_FROM_ALL)
  endif()
  set(CPACK_COMPONENT_${upper}_DEPENDS ${debian_NEEDS} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${debian_PACKAGE} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${debian_SECTION} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${debian_SUMMARY}\n${debian_DESCRIPTION}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${debian_DEPENDS}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_RECOMMENDS "${debian_RECOMMENDS}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA "${scripts}" PARENT_SCOPE)
  if(debian_ARCHITECTURE)
    set(CPACK_DEBIAN_${upper}_PACKAGE_ARCHITECTURE ${debian_ARCHITECTURE} PARENT_SCOPE)
  else()
    set(CPACK_DEBIAN_${upper}_PACKAGE_SHLIBDEPS ON PARENT_SCOPE)
  endif()
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} PARENT_SCOPE)
endfunction()

set(about "byre is visual SLAM with one camera, a stereo camera or a depth camera. Each\nframe yields a pose with covariance and a trust verdict.")
if(BYRE_ARCH)
  set(processors "\nIt needs a processor with the instruction set ${BYRE_ARCH}.")
endif()

# Libraries loaded by dlopen on first use, which dpkg-shlibdeps cannot find.
foreach(module imgcodecs videoio)
  get_target_property(file opencv_${module} LOCATION)
  execute_process(COMMAND dpkg-query --search ${file} OUTPUT_VARIABLE owner ERROR_QUIET)
  if(owner MATCHES "^([^:]+):")
    list(APPEND byre_loaded ${CMAKE_MATCH_1})
  endif()
endforeach()
list(JOIN byre_loaded ", " byre_loaded)
set(byre_program_loaded ${byre_loaded})
if(BYRE_HAS_LIBPQ)
  string(APPEND byre_program_loaded ", libpq5")
endif()

set(CPACK_COMPONENTS_ALL)
byre_add_package(data PACKAGE byre-data SECTION science ARCHITECTURE all
  SUMMARY "visual SLAM for robots - data"
  DESCRIPTION "${about}\n.\nThis package contains the visual vocabulary for place recognition, the\nprotocols of benchmarks, and the schema of the registry.")
if(BYRE_BUILD_CLI)
  byre_add_package(program PACKAGE byre SECTION science NEEDS data DEPENDS "${byre_program_loaded}"
    SUMMARY "visual SLAM for robots - program"
    DESCRIPTION "${about}${processors}\n.\nThis package contains the program, its manual pages, and completions for\nbash and zsh.")
endif()
byre_add_package(runtime PACKAGE libbyre${PROJECT_VERSION_MAJOR} SECTION libs NEEDS data
  SUMMARY "visual SLAM for robots - shared library"
  DESCRIPTION "${about}${processors}\n.\nThis package contains the shared library for programs on robots.")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY "=") # before 1.0 a minor version may break the interface
set(byre_embree_package)
if(BYRE_HAS_EMBREE)
  set(byre_embree_package "libembree-dev, ")
endif()
if(BYRE_HAS_APRILTAG)
  set(byre_apriltag_package "libapriltag-dev, ")
endif()
byre_add_package(development PACKAGE libbyre-dev SECTION libdevel NEEDS runtime DEPENDS libeigen3-dev
  RECOMMENDS "libceres-dev, libopencv-dev, libfmt-dev, libyaml-cpp-dev, nlohmann-json3-dev, libtinyxml2-dev, libxxhash-dev, libhwy-dev, libdeflate-dev, libjpeg-dev, ${byre_embree_package}${byre_apriltag_package}libsqlite3-dev, libzstd-dev, liblz4-dev, libbz2-dev, zlib1g-dev"
  SUMMARY "visual SLAM for robots - development files"
  DESCRIPTION "${about}\n.\nThis package contains the headers, the CMake and pkg-config packages, and the\nstatic libraries, which need the recommended packages at link time.")
byre_add_package(doc PACKAGE byre-doc SECTION doc ARCHITECTURE all
  SUMMARY "visual SLAM for robots - documentation"
  DESCRIPTION "${about}\n.\nThis package contains the documentation and examples of programs.")
if(BYRE_HAS_PYBIND11)
  math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
  byre_add_package(python PACKAGE python3-byre SECTION python NEEDS data
    DEPENDS "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next_minor}), python3-numpy, ${byre_loaded}"
    SUMMARY "visual SLAM for robots - Python 3"
    DESCRIPTION "${about}${processors}\n.\nThis package contains the Python library, with numpy arrays for images and\nposes.")
endif()

# All targets that packages contain.
get_property(components GLOBAL PROPERTY BYRE_COMPONENTS)
list(TRANSFORM components PREPEND byre_component_)
set(packaged byre_shared byre_manual byre_python byre_docs ${components})
add_custom_target(byre_packaged)
foreach(target IN LISTS packaged)
  if(TARGET ${target})
    add_dependencies(byre_packaged ${target})
  endif()
endforeach()

include(CPack)
