# Unity builds: several files compile as one, so that common includes, which dominate the compile time of tests and
# commands, are parsed once. Names in anonymous namespaces must therefore be unique in a folder, in cli in the room, see
# tools/check_floors.py. A fresh build of byre_cli on two cores takes 4 minutes, without unity builds about 22.
option(BYRE_UNITY "Compile several files of a folder as one (unity build)" ON)

# Folders whose tests compile separately, with the optimisation of the library. In large files, or with less
# optimisation, the compiler does not inline Eigen's allocation functions, see tools/check_allocations.sh, which checks
# only this build.
if(NOT BYRE_SANITIZE AND NOT CMAKE_CROSSCOMPILING)
  set(BYRE_TESTS_APART optimise)
endif()

# Files that include themselves once per instruction set. GCC 12 for ARM crashes on the vectors of arm_sve.h after a
# precompiled header.
set(BYRE_FILES_BY_PROCESSOR features/downscale.cc features/remap.cc features/gaussian_blur.cc features/fast_corners.cc
    features/block_differences.cc features/align_sums.cc features/descriptor.cc features/row_costs.cc
    optimise/pose_expansion.cc)
# Files whose objects are linked individually.
set(BYRE_FILES_PICKED viewer/web/web_library.cc)
# Files with many Eigen types, which GCC compiles twice as slowly in a unity build as alone.
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
