# Several files as one: what they include is then read once for all of them, which is most of compiling a test or a
# command. Names in anonymous namespaces must so be unique in a room, see tools/check_floors.py.
option(BYRE_UNITY "Compile several files of a room as one: a build from scratch has half the objects" ON)

# Rooms whose tests are apart, and optimised as the library is: in a large file, or for a short build, the compiler does
# not put Eigen's allocation where it is called, see tools/check_allocations.sh. Elsewhere that is not looked for.
if(NOT BYRE_SANITIZE AND NOT CMAKE_CROSSCOMPILING)
  set(BYRE_TESTS_APART optimise)
endif()

# Files that include themselves once for each processor. GCC 12 for ARM crashes on the vectors of arm_sve.h after a
# precompiled header.
set(BYRE_FILES_BY_PROCESSOR features/downscale.cc features/remap.cc features/gaussian_blur.cc features/fast_corners.cc
    features/block_differences.cc features/align_sums.cc features/descriptor.cc features/row_costs.cc
    optimise/pose_expansion.cc)
# Files whose objects are picked one by one.
set(BYRE_FILES_PICKED dataset/calibration_file.cc dataset/calibration_fields.cc dataset/camera_fields.cc
    viewer/web_library.cc)
# Files of so many kinds of Eigen's matrices that GCC takes twice as long for them and others as for each by itself.
set(BYRE_FILES_LARGE geometry/essential.cc)
list(TRANSFORM BYRE_FILES_BY_PROCESSOR PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/src/byre/)
list(TRANSFORM BYRE_FILES_PICKED PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/src/byre/)
list(TRANSFORM BYRE_FILES_LARGE PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/src/byre/)
set_source_files_properties(${BYRE_FILES_BY_PROCESSOR} ${BYRE_FILES_PICKED} ${BYRE_FILES_LARGE} PROPERTIES
                            SKIP_UNITY_BUILD_INCLUSION ON)
set_source_files_properties(${BYRE_FILES_BY_PROCESSOR} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)

function(byre_unite target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${BYRE_UNITY} UNITY_BUILD_BATCH_SIZE 16)
endfunction()
