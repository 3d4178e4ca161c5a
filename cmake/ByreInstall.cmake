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
      target_sources(${library} PUBLIC FILE_SET HEADERS BASE_DIRS ${CMAKE_CURRENT_SOURCE_DIR}/include FILES ${headers})
    endif()
    install(TARGETS ${library} EXPORT byre_${component}
            ARCHIVE COMPONENT development
            LIBRARY COMPONENT runtime NAMELINK_COMPONENT development
            FILE_SET HEADERS COMPONENT development)
    install(EXPORT byre_${component} NAMESPACE byre:: FILE byre_${component}.cmake DESTINATION ${package_dir}
            COMPONENT development)
  endforeach()
  configure_package_config_file(${CMAKE_CURRENT_SOURCE_DIR}/cmake/byreConfig.cmake.in
                                ${CMAKE_CURRENT_BINARY_DIR}/byreConfig.cmake INSTALL_DESTINATION ${package_dir})
  write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/byreConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/byreConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/byreConfigVersion.cmake
          DESTINATION ${package_dir} COMPONENT development)
endfunction()

# byre's own data, vocabulary and benchmark protocols, at the location where base/data_file.cc searches for it.
function(byre_install_data)
  set(folder share/byre)
  install(FILES ${folder}/default.vocabulary DESTINATION ${CMAKE_INSTALL_DATADIR}/byre COMPONENT data)
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

# systemd service of `byre node`, not enabled by default, and its ROS files.
function(byre_install_service)
  byre_install_dir(service_dir ${CMAKE_INSTALL_LIBDIR}/systemd/system lib/systemd/system program)
  install(FILES share/systemd/byre.service DESTINATION ${service_dir} COMPONENT program)
  install(DIRECTORY ros2 DESTINATION ${CMAKE_INSTALL_DATADIR}/byre COMPONENT program)
endfunction()
