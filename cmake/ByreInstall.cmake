# Installation: the library, its headers, and the package files for find_package(byre). Each file belongs to a
# component, which ByrePackages.cmake turns into a Debian package.
include(CMakePackageConfigHelpers)

# Installs the headers of include/byre, which include only the standard library and Eigen. Headers of rooms are
# internal.
function(byre_install_library)
  file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/include/byre/*.h)
  set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/byre)
  get_property(components GLOBAL PROPERTY BYRE_COMPONENTS)
  list(TRANSFORM components PREPEND byre_component_ OUTPUT_VARIABLE libraries)
  if(TARGET byre_shared)
    list(APPEND components shared)
    list(APPEND libraries byre_shared)
  endif()
  foreach(component library IN ZIP_LISTS components libraries)
    if(component MATCHES "^(core|shared)$") # the two libraries that a program may link directly
      target_include_directories(${library} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                                                   $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    endif()
    install(TARGETS ${library} EXPORT byre_${component}
            ARCHIVE COMPONENT development
            LIBRARY COMPONENT runtime NAMELINK_COMPONENT development)
    install(EXPORT byre_${component} NAMESPACE byre:: FILE byre_${component}.cmake DESTINATION ${package_dir}
            COMPONENT development)
  endforeach()
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/byre COMPONENT development)
  configure_package_config_file(${CMAKE_CURRENT_SOURCE_DIR}/cmake/byreConfig.cmake.in
                                ${CMAKE_CURRENT_BINARY_DIR}/byreConfig.cmake INSTALL_DESTINATION ${package_dir})
  write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/byreConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/byreConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/byreConfigVersion.cmake
          DESTINATION ${package_dir} COMPONENT development)
  if(TARGET byre_shared)
    byre_install_pkg_config()
  endif()
endfunction()

# byre.pc, for the shared library. Its prefix is relative to its own place, so that the installation can be moved.
function(byre_install_pkg_config)
  set(folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
  file(RELATIVE_PATH to_prefix /prefix/${folder} /prefix)
  string(REGEX REPLACE "/$" "" to_prefix ${to_prefix})
  configure_file(${CMAKE_CURRENT_SOURCE_DIR}/cmake/byre.pc.in ${CMAKE_CURRENT_BINARY_DIR}/byre.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/byre.pc DESTINATION ${folder} COMPONENT development)
endfunction()

# byre's own data, vocabulary and benchmark protocols, at the location where base/data_file.cc searches for it.
function(byre_install_data)
  set(folder share/byre)
  install(FILES ${folder}/default.vocabulary DESTINATION ${CMAKE_INSTALL_DATADIR}/byre COMPONENT data)
  install(DIRECTORY ${folder}/registry DESTINATION ${CMAKE_INSTALL_DATADIR}/byre COMPONENT data)
  install(PROGRAMS scripts/registry.sh DESTINATION ${CMAKE_INSTALL_DATADIR}/byre/registry COMPONENT data)
  install(DIRECTORY ${folder}/protocols DESTINATION ${CMAKE_INSTALL_DATADIR}/byre COMPONENT data)
  set_source_files_properties(src/byre/base/data_file.cc PROPERTIES COMPILE_DEFINITIONS
    "BYRE_DATA_IN_PREFIX=\"${CMAKE_INSTALL_DATADIR}/byre\";BYRE_INSTALLED_DATA=\"${CMAKE_INSTALL_FULL_DATADIR}/byre\";BYRE_SOURCE_DATA=\"${CMAKE_CURRENT_SOURCE_DIR}/${folder}\"")
endfunction()

# Sets a variable, for install(DESTINATION), to a folder below the prefix: debian_folder if the prefix is /usr, else
# folder. The prefix is not final before installation.
function(byre_install_dir variable folder debian_folder component)
  install(CODE "
    set(BYRE_${variable} ${folder})
    if(CMAKE_INSTALL_PREFIX MATCHES \"/usr$\")
      set(BYRE_${variable} ${debian_folder})
    endif()" COMPONENT ${component})
  set(${variable} "\${BYRE_${variable}}" PARENT_SCOPE)
endfunction()

# A systemd service, not enabled by default: of `byre node` or `byre worker`.
function(byre_install_service name)
  byre_install_dir(service_dir ${CMAKE_INSTALL_LIBDIR}/systemd/system lib/systemd/system program)
  install(FILES share/systemd/${name} DESTINATION ${service_dir} COMPONENT program)
endfunction()

# Package of ROS 2, by the layout of its resource index, which needs no ament: `ros2 run byre node`, `ros2 launch byre
# mission.launch.py`. The hooks extend the environment of a colcon workspace, see colcon.pkg.
function(byre_install_ros_package)
  install(DIRECTORY ros2 DESTINATION share/byre COMPONENT program
          PATTERN byre_ros EXCLUDE PATTERN colcon EXCLUDE PATTERN node.sh EXCLUDE PATTERN __pycache__ EXCLUDE)
  install(DIRECTORY ros2/colcon/ DESTINATION share/byre/hook COMPONENT program)
  install(PROGRAMS ros2/node.sh DESTINATION lib/byre RENAME node COMPONENT program)
  install(FILES package.xml DESTINATION share/byre COMPONENT program)
  set(marker ${CMAKE_CURRENT_BINARY_DIR}/ament_marker)
  file(TOUCH ${marker})
  install(FILES ${marker} DESTINATION share/ament_index/resource_index/packages RENAME byre COMPONENT program)
endfunction()

# Documentation, as HTML if mkdocs is installed, else as Markdown, with the examples and README.md at the place that
# pages refer to.
function(byre_install_docs)
  set(folder ${CMAKE_INSTALL_DATADIR}/doc/byre-doc)
  find_program(BYRE_MKDOCS mkdocs DOC "mkdocs, HTML pages of the documentation")
  if(BYRE_MKDOCS)
    set(site ${CMAKE_CURRENT_BINARY_DIR}/site)
    file(GLOB_RECURSE pages CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/docs/*)
    add_custom_command(OUTPUT ${site}/index.html DEPENDS ${pages} mkdocs.yml tools/site_links.py VERBATIM
      COMMAND ${BYRE_MKDOCS} build --quiet --clean --config-file ${CMAKE_CURRENT_SOURCE_DIR}/mkdocs.yml --site-dir ${site}
      COMMENT "Building the pages of the documentation")
    add_custom_target(byre_docs ALL DEPENDS ${site}/index.html)
    install(DIRECTORY ${site}/ DESTINATION ${folder}/html COMPONENT doc)
    message(STATUS "mkdocs: found, for HTML pages of the documentation")
  else()
    install(DIRECTORY docs DESTINATION ${folder} COMPONENT doc)
    message(STATUS "mkdocs: not found, documentation as Markdown instead of HTML (Debian: mkdocs)")
  endif()
  install(DIRECTORY examples DESTINATION ${folder} COMPONENT doc)
  install(FILES README.md CHANGELOG.md DESTINATION ${folder} COMPONENT doc)
endfunction()
