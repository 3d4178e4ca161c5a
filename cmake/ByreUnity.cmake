# Unity builds: several files compile as one, so that common includes, which dominate the compile time of tests and
# commands, are parsed once. A fresh build of byre_cli on two cores takes 4 minutes, without unity builds about 22.
# tools/unity_groups.py groups the files so that names local to a file may repeat. If the compiler reports a redefinition
# after a name was added, configure again.
option(BYRE_UNITY "Compile several files of a folder as one (unity build)" ON)

# Files that include themselves once per instruction set. GCC 12 for ARM crashes on the vectors of arm_sve.h after a
# precompiled header.
set(BYRE_FILES_BY_PROCESSOR features/downscale.cc features/remap.cc features/gaussian_blur.cc features/fast_corners.cc
    features/block_differences.cc features/align_sums.cc features/descriptor.cc features/row_costs.cc
    optimise/pose_expansion.cc)
# Files whose objects are linked individually.
set(BYRE_FILES_PICKED viewer/web/web_library.cc)
# Files with many Eigen types. Each adds variants of double to GCC's list, which it searches linearly: geometry takes 55 s
# of one processor as one file, 35 s with these compiled separately.
set(BYRE_FILES_LARGE geometry/essential.cc geometry/decompositions.cc geometry/homography.cc)
list(TRANSFORM BYRE_FILES_BY_PROCESSOR PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/src/byre/)
list(TRANSFORM BYRE_FILES_PICKED PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/src/byre/)
list(TRANSFORM BYRE_FILES_LARGE PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/src/byre/)
set_source_files_properties(${BYRE_FILES_BY_PROCESSOR} ${BYRE_FILES_PICKED} ${BYRE_FILES_LARGE} PROPERTIES
                            SKIP_UNITY_BUILD_INCLUSION ON)
set_source_files_properties(${BYRE_FILES_BY_PROCESSOR} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)

find_package(Python3 COMPONENTS Interpreter QUIET)
if(BYRE_UNITY AND NOT Python3_FOUND)
  message(STATUS "Unity builds are off, because Python 3 was not found: the build takes several times as long")
  set(BYRE_UNITY OFF)
endif()

function(byre_unite target)
  if(NOT BYRE_UNITY)
    return()
  endif()
  get_target_property(files ${target} SOURCES)
  list(FILTER files INCLUDE REGEX "^[^$]*\\.cc$")
  list(TRANSFORM files REPLACE "^([^/].*)$" "${CMAKE_CURRENT_SOURCE_DIR}/\\1")
  execute_process(
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/unity_groups.py ${PROJECT_SOURCE_DIR}/src/byre
      ${PROJECT_SOURCE_DIR}/include/byre 16 ${files}
    OUTPUT_VARIABLE groups COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "[0-9]+" groups "${groups}")
  foreach(file group IN ZIP_LISTS files groups)
    set_source_files_properties(${file} PROPERTIES UNITY_GROUP ${target}_${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()
