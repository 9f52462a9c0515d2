# One target per folder: hybridtest_library(<folder> [LINK targets…]) compiles every .cpp below the
# folder but main.cpp; hybridtest_program(<name> SOURCES … LINK …) makes a program.

# What our own code is compiled with, and generated code is not.
add_library(hybridtest_options INTERFACE)
target_compile_features(hybridtest_options INTERFACE cxx_std_20)
target_compile_options(hybridtest_options INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow)
# Instrumented code makes GCC warn of the standard library's own insides.
if(NOT HYBRIDTEST_SANITIZE)
  target_compile_options(hybridtest_options INTERFACE -Werror)
endif()
target_include_directories(hybridtest_options INTERFACE ${CMAKE_SOURCE_DIR})

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
# A seed must give the same bytes at every optimisation level: no fused multiply-add behind our back.
add_compile_options(-ffp-contract=off)
# HYBRIDTEST_ASSERT is always on; Eigen's own assertions are for debug builds.
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
if(HYBRIDTEST_SANITIZE)
  add_compile_options(-fsanitize=${HYBRIDTEST_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${HYBRIDTEST_SANITIZE})
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

function(hybridtest_library folder)
  cmake_parse_arguments(ARG "" "" "LINK" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  if(NOT sources)
    message(WARNING "${folder}: no sources yet")
    return()
  endif()
  add_library(hybridtest_${folder} STATIC ${sources})
  target_link_libraries(hybridtest_${folder} PRIVATE hybridtest_options ${ARG_LINK})
endfunction()

function(hybridtest_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE hybridtest_options ${ARG_LINK})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
endfunction()
