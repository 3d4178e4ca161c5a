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
target_include_directories(byre_flags INTERFACE ${CMAKE_CURRENT_SOURCE_DIR}/src ${CMAKE_CURRENT_SOURCE_DIR}/include)
target_compile_definitions(byre_flags INTERFACE BYRE_VERSION="${PROJECT_VERSION}")

# Every room's test program, so that the unit tests can be built without the programs and examples.
if(BYRE_BUILD_TESTS)
  add_custom_target(byre_unit_tests)
endif()

set(BYRE_ROOM_LIBRARIES Eigen3::Eigen ${OpenCV_LIBS} Ceres::ceres yaml-cpp nlohmann_json::nlohmann_json Threads::Threads
    ${BYRE_XXHASH} ${BYRE_EMBREE} $<BUILD_INTERFACE:Boost::headers>)

# Adds src/byre/<room>: its objects as byre_<room>, and its tests as byre_<room>_tests.
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

# A part of the library that can be linked alone, byre::<component>: the objects of its rooms, the components it needs
# and the libraries it is linked with. Consumers need C++20, Eigen and the same alignment; see ByreInstall.cmake for the
# headers.
function(byre_add_component component)
  cmake_parse_arguments(PARSE_ARGV 1 part "" "" "ROOMS;NEEDS;LINKS")
  set(library byre_component_${component})
  add_library(${library})
  add_library(byre::${component} ALIAS ${library})
  set_target_properties(${library} PROPERTIES OUTPUT_NAME byre_${component} EXPORT_NAME ${component})
  foreach(room IN LISTS part_ROOMS)
    target_sources(${library} PRIVATE $<TARGET_OBJECTS:byre_${room}>)
  endforeach()
  list(TRANSFORM part_NEEDS PREPEND byre_component_)
  target_compile_features(${library} PUBLIC cxx_std_20)
  target_compile_definitions(${library} PUBLIC EIGEN_MAX_ALIGN_BYTES=16)
  target_link_libraries(${library} PUBLIC Eigen3::Eigen ${part_NEEDS} PRIVATE ${part_LINKS} $<BUILD_INTERFACE:byre_flags>)
  set_property(GLOBAL APPEND PROPERTY BYRE_COMPONENTS ${component})
endfunction()

# All components as one, byre::byre.
function(byre_finish_library)
  add_library(byre INTERFACE)
  add_library(byre::byre ALIAS byre)
  get_property(components GLOBAL PROPERTY BYRE_COMPONENTS)
  list(TRANSFORM components PREPEND byre_component_)
  target_link_libraries(byre INTERFACE ${components})
endfunction()
