# Precompiled headers of the libraries that most files of the rooms include. They make a build from scratch faster, but
# compiler caches can do little with them, and a file that lacks an include compiles all the same: for servers that
# build anew each time, not for daily work. Commands have none: theirs would be so large that loading it takes longer.
option(BYRE_PRECOMPILE "Precompile headers: faster where no compiler cache is at hand" OFF)

set(BYRE_PRECOMPILED_room <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory>
    <optional> <random> <string> <string_view> <utility> <vector> <Eigen/Dense>)
set(BYRE_PRECOMPILED_test ${BYRE_PRECOMPILED_room} <gmock/gmock.h> <gtest/gtest.h>)

# The first target of a kind precompiles, the others of that kind, which must be compiled with the same flags, use what
# it has made.
function(byre_precompile kind target)
  if(NOT BYRE_PRECOMPILE)
    return()
  endif()
  get_property(first GLOBAL PROPERTY BYRE_PRECOMPILED_${kind}_BY)
  if(first)
    target_precompile_headers(${target} REUSE_FROM ${first})
  else()
    target_precompile_headers(${target} PRIVATE ${BYRE_PRECOMPILED_${kind}})
    set_property(GLOBAL PROPERTY BYRE_PRECOMPILED_${kind}_BY ${target})
  endif()
endfunction()
