# What `cmake --install` lays down: the library, its headers, and the package that find_package(byre) reads. Each file
# belongs to a component, which ByrePackages.cmake makes a package of.
include(CMakePackageConfigHelpers)

# Its headers are those of include/byre, which name the standard library and Eigen alone; those of the rooms stay home.
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
    if(component MATCHES "^(core|shared)$") # the two that a program may be linked with alone
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

# What comes with byre, the vocabulary and the protocols of benchmarks, and where input/data_file.cc looks for it.
function(byre_install_data)
  set(folder share/byre)
  install(FILES ${folder}/default.vocabulary DESTINATION ${CMAKE_INSTALL_DATADIR}/byre COMPONENT data)
  install(DIRECTORY ${folder}/protocols DESTINATION ${CMAKE_INSTALL_DATADIR}/byre COMPONENT data)
  set_source_files_properties(src/byre/input/data_file.cc PROPERTIES COMPILE_DEFINITIONS
    "BYRE_DATA_IN_PREFIX=\"${CMAKE_INSTALL_DATADIR}/byre\";BYRE_INSTALLED_DATA=\"${CMAKE_INSTALL_FULL_DATADIR}/byre\";BYRE_SOURCE_DATA=\"${CMAKE_CURRENT_SOURCE_DIR}/${folder}\"")
endfunction()

# Sets a variable, for install(DESTINATION), to a folder below the prefix: to the first one given, or to the second when
# the prefix is Debian's own, /usr, which is known no sooner than at the installation.
function(byre_install_dir variable folder debian_folder component)
  install(CODE "
    set(BYRE_${variable} ${folder})
    if(CMAKE_INSTALL_PREFIX MATCHES \"/usr$\")
      set(BYRE_${variable} ${debian_folder})
    endif()" COMPONENT ${component})
  set(${variable} "\${BYRE_${variable}}" PARENT_SCOPE)
endfunction()

# The service of `byre node`, for systemd, which only an administrator starts; and what goes with it in ROS.
function(byre_install_service)
  byre_install_dir(service_dir ${CMAKE_INSTALL_LIBDIR}/systemd/system lib/systemd/system program)
  install(FILES share/systemd/byre.service DESTINATION ${service_dir} COMPONENT program)
  install(DIRECTORY ros2 DESTINATION ${CMAKE_INSTALL_DATADIR}/byre COMPONENT program)
endfunction()
