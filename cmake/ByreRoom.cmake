# How rooms become the library: one object library a room, so that a room and the floors below it build and test alone.

# Flags every target of this project is compiled with. They stay inside: consumers get only what the headers need.
add_library(byre_flags INTERFACE)
target_compile_features(byre_flags INTERFACE cxx_std_20)
target_compile_options(byre_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor)
# GCC collects garbage from 700 MB on, not from 130 MB: an eighth of its time for half a gigabyte more at most.
target_compile_options(byre_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=700000>)
if(BYRE_ARCH)
  target_compile_options(byre_flags INTERFACE -march=${BYRE_ARCH})
endif()
# What is rounded where must not depend on which files are compiled together.
target_compile_options(byre_flags INTERFACE -ffp-contract=off)
if(BYRE_SANITIZE)
  target_compile_options(byre_flags INTERFACE -fsanitize=${BYRE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(byre_flags INTERFACE -fsanitize=${BYRE_SANITIZE})
  target_compile_definitions(byre_flags INTERFACE BYRE_SANITIZED)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL Clang AND BYRE_UNITY) # it takes another file's constants for shadowed ones
  target_compile_options(byre_flags INTERFACE -Wno-shadow)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL Clang AND BYRE_SANITIZE)
  target_compile_options(byre_flags INTERFACE "SHELL:-include ${CMAKE_CURRENT_SOURCE_DIR}/cmake/quick_random.h")
endif()
# Debian's Ceres is built for 16-byte alignment; byre and its consumers must agree with it whatever -march they use.
target_compile_definitions(byre_flags INTERFACE EIGEN_MAX_ALIGN_BYTES=16)
target_include_directories(byre_flags INTERFACE ${CMAKE_CURRENT_SOURCE_DIR}/src ${CMAKE_CURRENT_SOURCE_DIR}/include)
target_compile_definitions(byre_flags INTERFACE BYRE_VERSION="${PROJECT_VERSION}")

# Every room's test program, so that the unit tests can be built without the programs and examples.
if(BYRE_BUILD_TESTS)
  add_custom_target(byre_unit_tests)
endif()

# Rooms in which nothing is hot and much is libraries' templates, which GCC takes a third less time to compile so. What
# robots link, and what figures come from, is not among them: see also cli/CMakeLists.txt.
set(BYRE_ROOMS_COLD ros bag viewer benchmark demo dds fleet node)

# Compiles a target for a short build rather than for a fast program.
function(byre_compile_quickly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# What tests do by themselves is little: under sanitizers they take a third of the time to compile so, and run as fast.
function(byre_compile_test target)
  byre_compile_quickly(${target})
  if(BYRE_SANITIZE)
    target_compile_options(${target} PRIVATE -O0)
  endif()
endfunction()

# Those whose tests take longest, so that none of them runs alone at the end.
set(BYRE_ROOMS_TESTED_FIRST session slam playback simulation)

# Those whose tests read files of the source tree or beside it. The others do not know where it is, so that clones in
# several folders share what the compiler cache has.
set(BYRE_ROOMS_WITH_DATA dataset evaluation place)

set(BYRE_ROOM_LIBRARIES Eigen3::Eigen ${OpenCV_LIBS} Ceres::ceres yaml-cpp nlohmann_json::nlohmann_json Threads::Threads
    ${BYRE_FMT} ${BYRE_XXHASH} ${BYRE_HIGHWAY} ${BYRE_DEFLATE} ${BYRE_EMBREE} ${BYRE_BAGS} $<BUILD_INTERFACE:Boost::headers>)

# Adds src/byre/<room>: its objects as byre_<room>, and its tests as byre_<room>_tests. LINKS: what it needs beside what
# all rooms are linked with.
function(byre_add_room room)
  cmake_parse_arguments(PARSE_ARGV 1 its "" "" "LINKS")
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/byre/${room}/*.cc)
  set(tests ${sources})
  list(FILTER sources EXCLUDE REGEX "_(test|scene)\\.cc$")
  list(FILTER tests INCLUDE REGEX "_(test|scene)\\.cc$")
  if(NOT sources)
    return()
  endif()
  add_library(byre_${room} OBJECT ${sources})
  target_link_libraries(byre_${room} PRIVATE byre_flags ${BYRE_ROOM_LIBRARIES} ${its_LINKS})
  set_target_properties(byre_${room} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  if(room IN_LIST BYRE_ROOMS_COLD)
    byre_compile_quickly(byre_${room})
    byre_precompile(cold_room byre_${room})
  else()
    byre_precompile(room byre_${room})
  endif()
  byre_unite(byre_${room})

  get_property(rooms_below GLOBAL PROPERTY BYRE_ROOMS_ADDED)
  set_property(GLOBAL APPEND PROPERTY BYRE_ROOMS_ADDED ${room})
  if(tests AND BYRE_BUILD_TESTS)
    add_library(byre_${room}_test_files OBJECT ${tests})
    target_link_libraries(byre_${room}_test_files PRIVATE byre_flags ${BYRE_ROOM_LIBRARIES} ${its_LINKS} GTest::gmock)
    if(room IN_LIST BYRE_ROOMS_WITH_DATA)
      target_compile_definitions(byre_${room}_test_files PRIVATE BYRE_SOURCE_DIR="${CMAKE_CURRENT_SOURCE_DIR}")
    endif()
    if(room IN_LIST BYRE_TESTS_APART)
      byre_precompile(test_apart byre_${room}_test_files)
    else()
      byre_compile_test(byre_${room}_test_files)
      byre_precompile(test byre_${room}_test_files)
      byre_unite(byre_${room}_test_files)
    endif()
    # Linked last: of what both have made of a template the library's is taken.
    add_executable(byre_${room}_tests $<TARGET_OBJECTS:byre_${room}>)
    foreach(below IN LISTS rooms_below)
      target_sources(byre_${room}_tests PRIVATE $<TARGET_OBJECTS:byre_${below}>)
    endforeach()
    target_sources(byre_${room}_tests PRIVATE $<TARGET_OBJECTS:byre_${room}_test_files>)
    target_link_libraries(byre_${room}_tests PRIVATE byre_flags ${BYRE_ROOM_LIBRARIES} ${its_LINKS} GTest::gmock_main)
    set_target_properties(byre_${room}_tests PROPERTIES LINKER_LANGUAGE CXX)
    add_dependencies(byre_unit_tests byre_${room}_tests)
    add_test(NAME ${room} COMMAND byre_${room}_tests)
    set_tests_properties(${room} PROPERTIES LABELS unit)
    if(room IN_LIST BYRE_ROOMS_TESTED_FIRST)
      set_tests_properties(${room} PROPERTIES COST 70)
    endif()
  endif()
endfunction()

# Consumers need C++20, Eigen and the same alignment; see ByreInstall.cmake for the headers.
function(byre_set_usage library)
  target_compile_features(${library} PUBLIC cxx_std_20)
  target_compile_definitions(${library} PUBLIC EIGEN_MAX_ALIGN_BYTES=16)
  target_link_libraries(${library} PUBLIC Eigen3::Eigen PRIVATE $<BUILD_INTERFACE:byre_flags>)
endfunction()

# A part of the library that can be linked alone, byre::<component>: the objects of its rooms, the components it needs
# and the libraries it is linked with. Static whatever BUILD_SHARED_LIBS says: see byre_add_shared_library.
function(byre_add_component component)
  cmake_parse_arguments(PARSE_ARGV 1 part "" "" "ROOMS;NEEDS;LINKS")
  set(library byre_component_${component})
  add_library(${library} STATIC)
  add_library(byre::${component} ALIAS ${library})
  set_target_properties(${library} PROPERTIES OUTPUT_NAME byre_${component} EXPORT_NAME ${component})
  foreach(room IN LISTS part_ROOMS)
    target_sources(${library} PRIVATE $<TARGET_OBJECTS:byre_${room}>)
  endforeach()
  list(TRANSFORM part_NEEDS PREPEND byre_component_)
  byre_set_usage(${library})
  target_link_libraries(${library} PUBLIC ${part_NEEDS} PRIVATE ${part_LINKS})
  set_property(GLOBAL APPEND PROPERTY BYRE_COMPONENTS ${component})
endfunction()

# libbyre.so, byre::shared: the objects of the component core and those that read calibrations, so that it needs neither
# image files nor videos. Programs see what the public headers declare, but for recordings and floor plans.
function(byre_add_shared_library)
  add_library(byre_shared SHARED)
  target_sources(byre_shared PRIVATE
    "$<FILTER:$<TARGET_OBJECTS:byre_dataset>,INCLUDE,/(calibration_file|calibration_fields|camera_fields)[.]cc>")
  add_library(byre::shared ALIAS byre_shared)
  get_target_property(objects byre_component_core SOURCES)
  get_target_property(links byre_component_core LINK_LIBRARIES)
  target_sources(byre_shared PRIVATE ${objects})
  byre_set_usage(byre_shared)
  target_link_libraries(byre_shared PRIVATE ${links} yaml-cpp)
  set_target_properties(byre_shared PROPERTIES OUTPUT_NAME byre EXPORT_NAME shared LINKER_LANGUAGE CXX
                        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})

  find_package(Python3 COMPONENTS Interpreter REQUIRED)
  set(script ${CMAKE_CURRENT_SOURCE_DIR}/cmake/make_exports.py)
  set(exports ${CMAKE_CURRENT_BINARY_DIR}/byre_exports.map)
  file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/include/byre/*.h)
  list(FILTER headers EXCLUDE REGEX "/(floor_plan|recording)\\.h$")
  # Before 1.0 a minor version may break the interface, so both numbers are in every program that is linked.
  add_custom_command(OUTPUT ${exports} DEPENDS ${script} ${headers} VERBATIM
    COMMAND Python3::Interpreter ${script} ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} ${exports} ${headers})
  target_sources(byre_shared PRIVATE ${exports})
  set_target_properties(byre_shared PROPERTIES LINK_DEPENDS ${exports})
  target_link_options(byre_shared PRIVATE
                      LINKER:--version-script=${exports} LINKER:--as-needed LINKER:--no-undefined)
endfunction()

# All components as one, byre::byre.
function(byre_finish_library)
  add_library(byre INTERFACE)
  add_library(byre::byre ALIAS byre)
  get_property(components GLOBAL PROPERTY BYRE_COMPONENTS)
  list(TRANSFORM components PREPEND byre_component_)
  target_link_libraries(byre INTERFACE ${components})
endfunction()
