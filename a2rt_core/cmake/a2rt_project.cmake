# Compiler settings that every target of the project shares.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
# Checks stay on in release builds: a wrong number is worse than a slow one.
set(CMAKE_CXX_FLAGS_RELEASE "-O2")

find_program(A2RT_CCACHE ccache)
if(A2RT_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${A2RT_CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${A2RT_CCACHE})
endif()

add_library(a2rt_build_flags INTERFACE)
add_library(a2rt::build_flags ALIAS a2rt_build_flags)
target_compile_options(a2rt_build_flags INTERFACE
  -Wall -Wextra -Wconversion -Wshadow -Werror
  # Clang counts it to -Wconversion; what one compiler refuses, the other shall too.
  $<$<CXX_COMPILER_ID:GNU>:-Wsign-conversion>
  # Results must not depend on whether the compiler fuses a multiply and an add: every bound in
  # arith/ is proved for separately rounded operations.
  -ffp-contract=off
  # Signed zeros, NaN and infinities are inputs the units promise to handle.
  -fno-fast-math)
if(A2RT_SANITIZE)
  target_compile_options(a2rt_build_flags INTERFACE
    -fsanitize=${A2RT_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g)
  target_link_options(a2rt_build_flags INTERFACE -fsanitize=${A2RT_SANITIZE})
endif()

# Set-up turns this on: most of a file's compile time goes to headers that its neighbours include
# too. Off for development, where one changed file should compile alone.
option(A2RT_TOGETHER "Compile the files of a library several at a time" OFF)

# a2rt_compile_together(TARGET)
# Allows it for one library; its files then share their anonymous namespaces.
function(a2rt_compile_together TARGET)
  if(A2RT_TOGETHER)
    set_target_properties(${TARGET} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 6)
  endif()
endfunction()

# a2rt_compile_quickly(SOURCES ...)
# For files that run once a command and consist of large header libraries: optimising them takes as
# long as everything else about them, and nothing would run noticeably faster.
function(a2rt_compile_quickly)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS -O0)
endfunction()

# a2rt_room(NAME SOURCES ... [DEPENDS ...] [PRIVATE_DEPENDS ...])
# One room of a2rt_core: library a2rt_NAME, alias a2rt::NAME, headers in include/a2rt/NAME.
# DEPENDS must follow  base <- arith <- bvh <- rt <- timing <- energy  (tests/repo checks it).
function(a2rt_room NAME)
  cmake_parse_arguments(ROOM "" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  add_library(a2rt_${NAME} STATIC ${ROOM_SOURCES})
  add_library(a2rt::${NAME} ALIAS a2rt_${NAME})
  target_include_directories(a2rt_${NAME} PUBLIC ${PROJECT_SOURCE_DIR}/a2rt_core/include)
  target_link_libraries(a2rt_${NAME}
    PUBLIC ${ROOM_DEPENDS}
    PRIVATE a2rt::build_flags ${ROOM_PRIVATE_DEPENDS})
endfunction()
