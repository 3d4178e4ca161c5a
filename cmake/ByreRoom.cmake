# Builds the library from rooms: one object library per folder of a room, so that a room can be built and tested with
# the floors below it only.

# Compiler flags of every target of this project; not exported to consumers.
add_library(byre_flags INTERFACE)
target_compile_features(byre_flags INTERFACE cxx_std_20)
target_compile_options(byre_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor)
# Garbage collection of GCC starts at 700 MB instead of 130 MB: saves an eighth of its time for at most 0.5 GB more
# memory.
target_compile_options(byre_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=700000>)
if(BYRE_ARCH)
  target_compile_options(byre_flags INTERFACE -march=${BYRE_ARCH})
endif()
# Rounding must not depend on which files are compiled together.
target_compile_options(byre_flags INTERFACE -ffp-contract=off)
if(BYRE_SANITIZE)
  target_compile_options(byre_flags INTERFACE -fsanitize=${BYRE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(byre_flags INTERFACE -fsanitize=${BYRE_SANITIZE})
  target_compile_definitions(byre_flags INTERFACE BYRE_SANITIZED)
  if(BYRE_SANITIZE STREQUAL thread)
    target_compile_definitions(byre_flags INTERFACE BYRE_THREAD_SANITIZED) # see base/sanitizer_scene.h
  endif()
  # Each test program contains all objects of the floors below it, with line tables.
  find_program(BYRE_LLD ld.lld DOC "LLVM's linker, several times faster than that of binutils; used with sanitizers if installed")
  if(BYRE_LLD AND CMAKE_CXX_COMPILER_ID STREQUAL Clang)
    target_link_options(byre_flags INTERFACE -fuse-ld=lld)
  endif()
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL Clang AND BYRE_UNITY) # Clang reports constants of other files as shadowed
  target_compile_options(byre_flags INTERFACE -Wno-shadow)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL Clang AND BYRE_SANITIZE)
  target_compile_options(byre_flags INTERFACE "SHELL:-include ${CMAKE_CURRENT_SOURCE_DIR}/cmake/quick_random.h")
endif()
# Debian's Ceres is built for 16-byte alignment; byre and its consumers must use the same for any -march.
target_compile_definitions(byre_flags INTERFACE EIGEN_MAX_ALIGN_BYTES=16)
target_include_directories(byre_flags INTERFACE ${CMAKE_CURRENT_SOURCE_DIR}/src ${CMAKE_CURRENT_SOURCE_DIR}/include)
target_compile_definitions(byre_flags INTERFACE BYRE_VERSION="${PROJECT_VERSION}")

# Unit test programs by label: all; threads: of folders with threads, for the thread sanitizer; processor: of rooms with
# processor-specific code and the rooms they depend on.
if(BYRE_BUILD_TESTS)
  add_custom_target(byre_unit_tests)
  add_custom_target(byre_threads_tests)
  add_custom_target(byre_processor_tests)
endif()
set(BYRE_ROOMS_BY_PROCESSOR base geometry features optimise map place)

# A folder has threads if one of its files, tests included, includes a header of threads or locks, or a header of byre
# that does; these are recorded for the folders that follow. The header of executors and that of their workers name no
# thread, but an implementation starts one.
set(BYRE_THREAD_LIBRARY thread mutex shared_mutex condition_variable future stop_token latch barrier semaphore)
set_property(GLOBAL PROPERTY BYRE_THREAD_HEADERS base/executor.h base/worker.h)
function(byre_find_threads variable folder)
  list(JOIN BYRE_THREAD_LIBRARY "|" library)
  file(GLOB files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/byre/${folder}/*.h
                                    ${PROJECT_SOURCE_DIR}/src/byre/${folder}/*.cc)
  set(has_threads FALSE)
  foreach(file IN LISTS files)
    get_property(headers GLOBAL PROPERTY BYRE_THREAD_HEADERS)
    list(JOIN headers "|" headers)
    file(STRINGS ${file} includes REGEX "^#include (<(${library})>|\"byre/(${headers})\")")
    if(includes)
      set(has_threads TRUE)
      if(file MATCHES "\\.h$" AND includes MATCHES "<")
        cmake_path(RELATIVE_PATH file BASE_DIRECTORY ${PROJECT_SOURCE_DIR}/src/byre)
        set_property(GLOBAL APPEND PROPERTY BYRE_THREAD_HEADERS ${file})
      endif()
    endif()
  endforeach()
  set(${variable} ${has_threads} PARENT_SCOPE)
endfunction()

# Adds tests of a program with GoogleTest: <name>, and <name>_long of its suites and instantiations whose names begin
# with LongRun, if FILES contain some. FILTER and EXCEPT: patterns of test names; LABELS: those of both tests. The second
# also has the label long.
function(byre_add_google_test name program)
  cmake_parse_arguments(PARSE_ARGV 2 its "" "" "FILTER;EXCEPT;LABELS;FILES")
  list(JOIN its_FILTER ":" filter)
  list(JOIN its_EXCEPT ":" except)
  add_test(NAME ${name} COMMAND ${program} --gtest_filter=${filter}-LongRun*:*/LongRun*:${except})
  set_tests_properties(${name} PROPERTIES LABELS "${its_LABELS}")
  foreach(file IN LISTS its_FILES)
    file(STRINGS ${file} found REGEX "^(TEST|TEST_F|TEST_P|INSTANTIATE_TEST_SUITE_P)\\(LongRun")
    if(found)
      add_test(NAME ${name}_long COMMAND ${program} --gtest_filter=LongRun*:*/LongRun*)
      set_tests_properties(${name}_long PROPERTIES LABELS "${its_LABELS};long")
      return()
    endif()
  endforeach()
endfunction()

# Folders without hot code but with many library templates: -O1 saves a third of their compile time. Excludes code
# that robots link or that produces figures; see also cli/CMakeLists.txt.
set(BYRE_FOLDERS_COLD io/ros io/bag viewer viewer/web benchmark benchmark/demo ros2/dds ros2/fleet ros2/node)

# Folders whose tests compute much by themselves, or by inlined functions. The others are compiled without optimisation,
# in half the time: what they render or simulate is in byre_scenes.
set(BYRE_FOLDERS_TESTED_HEAVILY features geometry geometry/evaluation optimise odometry map map/plan place simulation
    simulation/cowshed)

# Compiles a target for short build time instead of speed.
function(byre_compile_quickly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# Compiles a target of the release without optimisation: tests that compute little. Sanitizers are too slow without.
function(byre_compile_lightly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O0>)
endfunction()

# Folders with the code that fuzz/ tests. Builds with Clang's address sanitizer record its coverage and detect all
# undefined behaviour, so that the fuzzers need no build of their own.
if(CMAKE_CXX_COMPILER_ID STREQUAL Clang AND BYRE_SANITIZE MATCHES "address")
  set(BYRE_BUILD_FUZZERS ON)
  set(BYRE_FUZZED_OPTIONS -fsanitize=undefined -fno-sanitize-recover=all
      -fsanitize-coverage=inline-8bit-counters,pc-table,indirect-calls,trace-cmp)
  set(BYRE_FOLDERS_FUZZED base geometry odometry map map/plan io/ros io/bag io/calibration)
endif()

# Folders with a separate test program, byre_<room>_<folder>_tests. The others share the program of their room. Folders
# with and without threads are apart, so that the thread sanitizer builds few tests without threads.
set(BYRE_FOLDERS_TESTED_ALONE slam/window slam/mapping slam/localisation slam/session slam/upkeep slam/system playback/archive
    playback/report viewer/web ros2/dds ros2/fleet ros2/node)

# The slowest tests, started first so that none of them runs alone at the end.
set(BYRE_TESTED_FIRST slam_session slam playback simulation)

# Folders whose tests read files of the source tree. All others must not depend on its path, so that clones in several
# folders share the compiler cache.
set(BYRE_FOLDERS_WITH_DATA io/recording geometry/evaluation place)

set(BYRE_ROOM_LIBRARIES Eigen3::Eigen ${OpenCV_LIBS} Ceres::ceres yaml-cpp nlohmann_json::nlohmann_json Threads::Threads
    ${BYRE_TINYXML2} ${BYRE_FMT} ${BYRE_XXHASH} ${BYRE_HIGHWAY} ${BYRE_JPEG} ${BYRE_APRILTAG} ${BYRE_DEFLATE} ${BYRE_EMBREE} ${BYRE_BAGS} $<BUILD_INTERFACE:Boost::headers>)

# Sets a variable to the objects of rooms.
function(byre_objects_of variable)
  set(objects)
  foreach(room IN LISTS ARGN)
    get_property(in_room GLOBAL PROPERTY BYRE_OBJECTS_${room})
    list(APPEND objects ${in_room})
  endforeach()
  set(${variable} ${objects} PARENT_SCOPE)
endfunction()

# Adds the test program byre_<name>_tests of the room and of the rooms before it, with the label unit and those of
# LABELS. TEST_FILES: targets with its tests.
function(byre_add_test_program name room)
  cmake_parse_arguments(PARSE_ARGV 2 its "" "" "TEST_FILES;LINKS;LABELS")
  get_property(rooms_below GLOBAL PROPERTY BYRE_ROOMS_ADDED)
  byre_objects_of(objects ${room} ${rooms_below})
  if("simulation" IN_LIST rooms_below OR room STREQUAL simulation)
    list(APPEND objects $<TARGET_OBJECTS:byre_scenes>)
  endif()
  # Test objects are linked last, so that template instances of the library take precedence.
  set(files)
  foreach(target IN LISTS its_TEST_FILES)
    list(APPEND objects $<TARGET_OBJECTS:${target}>)
    get_target_property(sources ${target} SOURCES)
    list(APPEND files ${sources})
  endforeach()
  add_executable(byre_${name}_tests ${objects})
  target_link_libraries(byre_${name}_tests PRIVATE byre_flags ${BYRE_ROOM_LIBRARIES} ${its_LINKS} GTest::gmock_main)
  set_target_properties(byre_${name}_tests PROPERTIES LINKER_LANGUAGE CXX)
  set(labels unit ${its_LABELS})
  foreach(label IN LISTS labels)
    add_dependencies(byre_${label}_tests byre_${name}_tests)
  endforeach()
  byre_add_google_test(${name} byre_${name}_tests LABELS ${labels} FILES ${files})
  if(name IN_LIST BYRE_TESTED_FIRST)
    set_tests_properties(${name} PROPERTIES COST 70)
  endif()
endfunction()

# Adds the objects of src/byre/<folder> as byre_<folder>, those of its tests as byre_<folder>_test_files; in names of
# targets "_" replaces "/".
function(byre_add_folder folder)
  cmake_parse_arguments(PARSE_ARGV 1 its "" "" "LINKS")
  string(REPLACE "/" "_" name ${folder})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/byre/${folder}/*.cc)
  byre_leave_out(sources)
  set(tests ${sources})
  list(FILTER sources EXCLUDE REGEX "_(test|scene)\\.cc$")
  list(FILTER tests INCLUDE REGEX "_(test|scene)\\.cc$")
  if(folder STREQUAL simulation) # byre_scenes
    list(FILTER tests EXCLUDE REGEX "_scene\\.cc$")
  endif()
  if(sources)
    add_library(byre_${name} OBJECT ${sources})
    target_link_libraries(byre_${name} PRIVATE byre_flags ${BYRE_ROOM_LIBRARIES} ${its_LINKS})
    set_target_properties(byre_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    if(folder IN_LIST BYRE_FOLDERS_COLD)
      byre_compile_quickly(byre_${name})
      byre_precompile(cold_room byre_${name})
    else()
      byre_precompile(room byre_${name})
    endif()
    byre_unite(byre_${name})
    if(folder IN_LIST BYRE_FOLDERS_FUZZED)
      target_compile_options(byre_${name} PRIVATE ${BYRE_FUZZED_OPTIONS})
    endif()
  endif()
  if(tests AND BYRE_BUILD_TESTS)
    add_library(byre_${name}_test_files OBJECT ${tests})
    target_link_libraries(byre_${name}_test_files PRIVATE byre_flags ${BYRE_ROOM_LIBRARIES} ${its_LINKS} GTest::gmock)
    if(folder IN_LIST BYRE_FOLDERS_WITH_DATA)
      target_compile_definitions(byre_${name}_test_files PRIVATE BYRE_SOURCE_DIR="${CMAKE_CURRENT_SOURCE_DIR}")
    endif()
    if(folder IN_LIST BYRE_FOLDERS_TESTED_HEAVILY)
      byre_compile_quickly(byre_${name}_test_files)
      byre_precompile(test byre_${name}_test_files)
    else()
      byre_compile_lightly(byre_${name}_test_files)
      byre_precompile(light_test byre_${name}_test_files)
    endif()
    byre_unite(byre_${name}_test_files)
  endif()
endfunction()

# Adds byre_scenes, objects that render rooms and simulate missions for tests of the room simulation and those after it:
# compiled once, with optimisation.
function(byre_add_scenes)
  file(GLOB scenes CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/byre/simulation/*_scene.cc)
  add_library(byre_scenes OBJECT EXCLUDE_FROM_ALL ${scenes})
  target_link_libraries(byre_scenes PRIVATE byre_flags ${BYRE_ROOM_LIBRARIES})
  set_target_properties(byre_scenes PROPERTIES POSITION_INDEPENDENT_CODE ON) # as the room that owns the header
  byre_precompile(room byre_scenes)
endfunction()

# Adds the room src/byre/<room> with its folders and its tests, byre_<room>_tests. LINKS: libraries in addition to those
# of all rooms.
function(byre_add_room room)
  cmake_parse_arguments(PARSE_ARGV 1 its "" "" "LINKS")
  set(source ${CMAKE_CURRENT_SOURCE_DIR}/src/byre)
  file(GLOB folders CONFIGURE_DEPENDS RELATIVE ${source} ${source}/${room}/*)
  list(FILTER folders EXCLUDE REGEX "\\.")
  list(PREPEND folders ${room})
  set(labels)
  if(room IN_LIST BYRE_ROOMS_BY_PROCESSOR)
    set(labels processor)
  endif()
  set(test_files)
  set(shared_labels ${labels})
  set(programs)
  foreach(folder IN LISTS folders)
    set(folder_labels ${labels})
    byre_find_threads(has_threads ${folder})
    if(has_threads)
      list(APPEND folder_labels threads)
    endif()
    byre_add_folder(${folder} LINKS ${its_LINKS})
    string(REPLACE "/" "_" name ${folder})
    if(TARGET byre_${name})
      set_property(GLOBAL APPEND PROPERTY BYRE_OBJECTS_${room} $<TARGET_OBJECTS:byre_${name}>)
    endif()
    if(NOT TARGET byre_${name}_test_files OR (BYRE_SANITIZE STREQUAL thread AND NOT has_threads))
      continue()
    endif()
    if(folder IN_LIST BYRE_FOLDERS_TESTED_ALONE)
      list(APPEND programs ${name})
      set(labels_of_${name} ${folder_labels})
    else()
      list(APPEND test_files byre_${name}_test_files)
      list(APPEND shared_labels ${folder_labels})
    endif()
  endforeach()
  if(test_files)
    list(REMOVE_DUPLICATES shared_labels)
    byre_add_test_program(${room} ${room} TEST_FILES ${test_files} LINKS ${its_LINKS} LABELS ${shared_labels})
  endif()
  foreach(program IN LISTS programs)
    byre_add_test_program(${program} ${room} TEST_FILES byre_${program}_test_files LINKS ${its_LINKS}
                          LABELS ${labels_of_${program}})
  endforeach()
  set_property(GLOBAL APPEND PROPERTY BYRE_ROOMS_ADDED ${room})
endfunction()

# Consumers need C++20, Eigen and the same alignment; see ByreInstall.cmake for the headers.
function(byre_set_usage library)
  target_compile_features(${library} PUBLIC cxx_std_20)
  target_compile_definitions(${library} PUBLIC EIGEN_MAX_ALIGN_BYTES=16)
  target_link_libraries(${library} PUBLIC Eigen3::Eigen PRIVATE $<BUILD_INTERFACE:byre_flags>)
endfunction()

# Separately linkable part of the library, byre::<component>: the objects of its rooms, the components it needs and
# the libraries it links. Always static, see byre_add_shared_library.
function(byre_add_component component)
  cmake_parse_arguments(PARSE_ARGV 1 part "" "" "ROOMS;NEEDS;LINKS")
  set(library byre_component_${component})
  add_library(${library} STATIC)
  add_library(byre::${component} ALIAS ${library})
  set_target_properties(${library} PROPERTIES OUTPUT_NAME byre_${component} EXPORT_NAME ${component})
  byre_objects_of(objects ${part_ROOMS})
  target_sources(${library} PRIVATE ${objects})
  list(TRANSFORM part_NEEDS PREPEND byre_component_)
  byre_set_usage(${library})
  target_link_libraries(${library} PUBLIC ${part_NEEDS} PRIVATE ${part_LINKS})
  set_property(GLOBAL APPEND PROPERTY BYRE_COMPONENTS ${component})
endfunction()

# libbyre.so, byre::shared: the objects of core and those that read calibrations, without readers of image files, videos
# and bags. Exports the functions of the public headers, except COLMAP models, recordings and floor plans.
function(byre_add_shared_library)
  add_library(byre_shared SHARED $<TARGET_OBJECTS:byre_io_calibration> src/byre/io/recording/bag_frames_absent.cc)
  add_library(byre::shared ALIAS byre_shared)
  get_target_property(objects byre_component_core SOURCES)
  get_target_property(links byre_component_core LINK_LIBRARIES)
  target_sources(byre_shared PRIVATE ${objects})
  byre_set_usage(byre_shared)
  target_link_libraries(byre_shared PRIVATE ${links} yaml-cpp ${BYRE_TINYXML2})
  set_target_properties(byre_shared PROPERTIES OUTPUT_NAME byre EXPORT_NAME shared LINKER_LANGUAGE CXX
                        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})

  find_package(Python3 COMPONENTS Interpreter REQUIRED)
  set(script ${CMAKE_CURRENT_SOURCE_DIR}/cmake/make_exports.py)
  set(exports ${CMAKE_CURRENT_BINARY_DIR}/byre_exports.map)
  file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/include/byre/*.h)
  list(FILTER headers EXCLUDE REGEX "/(colmap|floor_plan|recording)\\.h$")
  # Before 1.0 a minor version may break the interface, so the version of the exported symbols contains both numbers.
  add_custom_command(OUTPUT ${exports} DEPENDS ${script} ${headers} VERBATIM
    COMMAND Python3::Interpreter ${script} ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} ${exports} ${headers})
  target_sources(byre_shared PRIVATE ${exports})
  set_target_properties(byre_shared PROPERTIES LINK_DEPENDS ${exports})
  target_link_options(byre_shared PRIVATE
                      LINKER:--version-script=${exports} LINKER:--as-needed LINKER:--no-undefined)
endfunction()

# All components, as byre::byre.
function(byre_finish_library)
  add_library(byre INTERFACE)
  add_library(byre::byre ALIAS byre)
  get_property(components GLOBAL PROPERTY BYRE_COMPONENTS)
  list(TRANSFORM components PREPEND byre_component_)
  target_link_libraries(byre INTERFACE ${components})
endfunction()
