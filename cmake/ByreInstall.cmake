# What `cmake --install` lays down: the library, its headers, and the package that find_package(byre) reads.
include(CMakePackageConfigHelpers)

# The headers of all rooms but those that name a foreign library other than Eigen, or a header that does: these are the
# rooms' own affair, and whoever uses byre needs nothing but Eigen to compile. Nor the scenes that tests are built on.
function(byre_public_headers result)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/byre/*.h)
  list(FILTER headers EXCLUDE REGEX "/src/byre/cli/|_scene\\.h$")
  set(internal "<(ceres|embree3|opencv2|yaml-cpp|nlohmann|gtest|gmock)/")
  set(count_before 0)
  list(LENGTH headers count)
  while(NOT count EQUAL count_before) # until no header is left that includes an internal one
    set(count_before ${count})
    foreach(header IN LISTS headers)
      file(STRINGS ${header} found REGEX "^#include (${internal})")
      if(found)
        list(REMOVE_ITEM headers ${header})
        file(RELATIVE_PATH name ${CMAKE_CURRENT_SOURCE_DIR}/src ${header})
        string(APPEND internal "|\"${name}\"")
      endif()
    endforeach()
    list(LENGTH headers count)
  endwhile()
  set(${result} ${headers} PARENT_SCOPE)
endfunction()

function(byre_install_library)
  byre_public_headers(headers)
  target_sources(byre PUBLIC FILE_SET HEADERS BASE_DIRS ${CMAKE_CURRENT_SOURCE_DIR}/src FILES ${headers})

  set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/byre)
  install(TARGETS byre EXPORT byreTargets FILE_SET HEADERS)
  install(EXPORT byreTargets NAMESPACE byre:: DESTINATION ${package_dir})
  configure_package_config_file(${CMAKE_CURRENT_SOURCE_DIR}/cmake/byreConfig.cmake.in
                                ${CMAKE_CURRENT_BINARY_DIR}/byreConfig.cmake INSTALL_DESTINATION ${package_dir})
  write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/byreConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/byreConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/byreConfigVersion.cmake
          DESTINATION ${package_dir})
endfunction()

# What comes with byre, the vocabulary and the protocols of benchmarks, and where input/data_file.cc looks for it.
function(byre_install_data)
  set(folder share/byre)
  install(FILES ${folder}/default.vocabulary DESTINATION ${CMAKE_INSTALL_DATADIR}/byre)
  install(DIRECTORY ${folder}/protocols DESTINATION ${CMAKE_INSTALL_DATADIR}/byre)
  file(RELATIVE_PATH from_program ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_DATADIR}/byre)
  set_source_files_properties(src/byre/input/data_file.cc PROPERTIES COMPILE_DEFINITIONS
    "BYRE_DATA_FROM_PROGRAM=\"${from_program}\";BYRE_INSTALLED_DATA=\"${CMAKE_INSTALL_FULL_DATADIR}/byre\";BYRE_SOURCE_DATA=\"${CMAKE_CURRENT_SOURCE_DIR}/${folder}\"")
endfunction()
