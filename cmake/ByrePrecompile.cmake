# Precompiled headers of the most used libraries, because parsing them dominates compile time. They hide missing
# includes.
option(BYRE_PRECOMPILE "Precompile the headers of libraries, which shortens a full build" ON)

set(BYRE_PRECOMPILED_room <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <fstream> <functional> <limits>
    <map> <memory> <numeric> <optional> <random> <span> <sstream> <string> <string_view> <tuple> <unordered_map>
    <utility> <variant> <vector> <Eigen/Dense>)
set(BYRE_PRECOMPILED_cold_room ${BYRE_PRECOMPILED_room})
set(BYRE_PRECOMPILED_test ${BYRE_PRECOMPILED_room} <gmock/gmock.h> <gtest/gtest.h>)
set(BYRE_PRECOMPILED_light_test ${BYRE_PRECOMPILED_test})
set(BYRE_PRECOMPILED_program ${BYRE_PRECOMPILED_room})
set(BYRE_PRECOMPILED_program_test ${BYRE_PRECOMPILED_test})
set(BYRE_PRECOMPILED_command ${BYRE_PRECOMPILED_room} <iostream> <nlohmann/json.hpp> <CLI/CLI.hpp>)
set(BYRE_PRECOMPILED_command_test ${BYRE_PRECOMPILED_command} <gmock/gmock.h> <gtest/gtest.h>)

# The first target of a kind builds the precompiled header. The others, which need the same compiler flags, reuse it.
function(byre_precompile kind target)
  if(NOT BYRE_PRECOMPILE)
    return()
  endif()
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>) # required by ccache
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # GCC before 13 treats precompiled system headers as user code and gives false warnings about the standard library.
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread
                           -Wno-maybe-uninitialized -Wno-restrict)
  endif()
  get_property(first GLOBAL PROPERTY BYRE_PRECOMPILED_${kind}_BY)
  if(first)
    target_precompile_headers(${target} REUSE_FROM ${first})
  else()
    target_precompile_headers(${target} PRIVATE ${BYRE_PRECOMPILED_${kind}})
    set_property(GLOBAL PROPERTY BYRE_PRECOMPILED_${kind}_BY ${target})
  endif()
endfunction()

# Precompiled header for programs. Their compile definitions differ, so a separate target owns it. KIND: program, or
# program_test if linked with GoogleTest; these are compiled lightly.
function(byre_precompile_program kind target)
  set(owner byre_precompiled_${kind})
  if(BYRE_PRECOMPILE AND NOT TARGET ${owner})
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${owner}.cc CONTENT "")
    add_library(${owner} OBJECT ${PROJECT_BINARY_DIR}/${owner}.cc)
    target_link_libraries(${owner} PRIVATE byre_flags Eigen3::Eigen $<$<STREQUAL:${kind},program_test>:GTest::gmock>)
    byre_precompile_program(${kind} ${owner})
  endif()
  if(kind STREQUAL program_test)
    byre_compile_lightly(${target})
  endif()
  byre_precompile(${kind} ${target})
endfunction()
