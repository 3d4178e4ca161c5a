# How rooms become the library: one object library a room, so that a room and the floors below it build and test alone.

# Flags every target of this project is compiled with. They stay inside: consumers get only what the headers need.
add_library(byre_flags INTERFACE)
target_compile_features(byre_flags INTERFACE cxx_std_20)
target_compile_options(byre_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor)
if(BYRE_ARCH)
  target_compile_options(byre_flags INTERFACE -march=${BYRE_ARCH})
endif()
if(BYRE_SANITIZE)
  target_compile_options(byre_flags INTERFACE -fsanitize=${BYRE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(byre_flags INTERFACE -fsanitize=${BYRE_SANITIZE})
endif()
# Debian's Ceres is built for 16-byte alignment; byre and its consumers must agree with it whatever -march they use.
target_compile_definitions(byre_flags INTERFACE EIGEN_MAX_ALIGN_BYTES=16)
target_include_directories(byre_flags INTERFACE ${CMAKE_CURRENT_SOURCE_DIR}/src)

# Every room's test program, so that the unit tests can be built without the programs and examples.
if(BYRE_BUILD_TESTS)
  add_custom_target(byre_unit_tests)
endif()

set(BYRE_ROOM_LIBRARIES Eigen3::Eigen ${OpenCV_LIBS} Ceres::ceres yaml-cpp nlohmann_json::nlohmann_json Threads::Threads
    ${BYRE_XXHASH} ${BYRE_EMBREE} $<BUILD_INTERFACE:Boost::headers>)

# Adds src/byre/<room>: its objects to the library byre, and its tests as byre_<room>_tests.
function(byre_add_room room)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/byre/${room}/*.cc)
  set(tests ${sources})
  list(FILTER sources EXCLUDE REGEX "_test\\.cc$")
  list(FILTER tests INCLUDE REGEX "_test\\.cc$")
  if(NOT sources)
    return()
  endif()
  add_library(byre_${room} OBJECT ${sources})
  target_link_libraries(byre_${room} PRIVATE byre_flags ${BYRE_ROOM_LIBRARIES})
  set_target_properties(byre_${room} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  byre_precompile(room byre_${room})
  target_sources(byre PRIVATE $<TARGET_OBJECTS:byre_${room}>)

  get_property(rooms_below GLOBAL PROPERTY BYRE_ROOMS_ADDED)
  set_property(GLOBAL APPEND PROPERTY BYRE_ROOMS_ADDED ${room})
  if(tests AND BYRE_BUILD_TESTS)
    add_executable(byre_${room}_tests ${tests} $<TARGET_OBJECTS:byre_${room}>)
    foreach(below IN LISTS rooms_below)
      target_sources(byre_${room}_tests PRIVATE $<TARGET_OBJECTS:byre_${below}>)
    endforeach()
    target_link_libraries(byre_${room}_tests PRIVATE byre_flags ${BYRE_ROOM_LIBRARIES} GTest::gmock_main)
    target_compile_definitions(byre_${room}_tests PRIVATE BYRE_SOURCE_DIR="${CMAKE_CURRENT_SOURCE_DIR}")
    byre_precompile(test byre_${room}_tests)
    add_dependencies(byre_unit_tests byre_${room}_tests)
    add_test(NAME ${room} COMMAND byre_${room}_tests)
    set_tests_properties(${room} PROPERTIES LABELS unit)
  endif()
endfunction()

# What the library asks of its consumers: C++20, Eigen and the same alignment; see ByreInstall.cmake for its headers.
function(byre_finish_library)
  target_compile_features(byre PUBLIC cxx_std_20)
  target_compile_definitions(byre PUBLIC EIGEN_MAX_ALIGN_BYTES=16)
  target_link_libraries(byre PUBLIC Eigen3::Eigen PRIVATE ${BYRE_ROOM_LIBRARIES} $<BUILD_INTERFACE:byre_flags>)
endfunction()
