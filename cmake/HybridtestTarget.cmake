# How a folder becomes a target: hybridtest_library() and hybridtest_program(), with files inside: hybridtest_embed_files().

include(GNUInstallDirs)

# What our own code is compiled with, and generated or foreign code is not.
add_library(hybridtest_options INTERFACE)
target_compile_options(hybridtest_options INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow)
# Instrumented code makes GCC warn of the standard library's own insides.
if(HYBRIDTEST_WARNINGS_AS_ERRORS AND NOT HYBRIDTEST_SANITIZE)
  target_compile_options(hybridtest_options INTERFACE -Werror)
endif()

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
# A seed must give the same bytes at every optimisation level: no fused multiply-add.
add_compile_options(-ffp-contract=off)
if(PROJECT_IS_TOP_LEVEL)
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
  if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release)
  endif()
  # HYBRIDTEST_ASSERT is always on; Eigen's own assertions are for debug builds.
  set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
  find_program(CCACHE_PROGRAM ccache)
  if(CCACHE_PROGRAM)
    # ccache takes a file with a precompiled header only with these two.
    set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
  endif()
endif()
if(HYBRIDTEST_SANITIZE)
  add_compile_options(-fsanitize=${HYBRIDTEST_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${HYBRIDTEST_SANITIZE})
  # Checks before each access through a pointer. They are a third of the time that GCC 12 takes to compile Eigen, and a
  # null or wild pointer ends a program under the address sanitizer without them.
  add_compile_options(-fno-sanitize=null,alignment,object-size,vptr)
  # Under the address sanitizer Eigen would lay out its memory in another way than the Eigen inside Ceres, which is not
  # instrumented; the linker keeps one of the two functions that free it.
  add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()

# The headers that most files include, parsed once: for libraries and programs, and with GoogleTest for tests.
function(hybridtest_precompiled name)
  cmake_parse_arguments(ARG "" "" "LINK;HEADERS" ${ARGN})
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp "// Compiles nothing: its precompiled header serves other targets.\n")
  add_library(${name} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_compile_options(${name} PRIVATE -fpch-preprocess)
  target_link_libraries(${name} PRIVATE hybridtest_options ${ARG_LINK})
  target_precompile_headers(${name} PRIVATE ${ARG_HEADERS})
endfunction()

set(hybridtest_common_headers
  <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <memory> <optional> <span> <string> <string_view>
  <variant> <vector> <Eigen/Dense>)
if(HYBRIDTEST_PRECOMPILED_HEADERS)
  hybridtest_precompiled(hybridtest_precompiled LINK Eigen3::Eigen HEADERS ${hybridtest_common_headers})
endif()

# Warnings, precompiled header and unity build of one of our targets.
function(hybridtest_compile target precompiled)
  get_target_property(type ${target} TYPE)
  if(type STREQUAL "EXECUTABLE")
    # As the libraries are compiled, so that the precompiled header fits.
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(${target} PRIVATE -fPIC)
  endif()
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:hybridtest_options>)
  if(HYBRIDTEST_PRECOMPILED_HEADERS)
    target_compile_options(${target} PRIVATE -fpch-preprocess)
    target_precompile_headers(${target} REUSE_FROM ${precompiled})
  endif()
  set_target_properties(${target} PROPERTIES
    UNITY_BUILD ${HYBRIDTEST_UNITY_BUILD} UNITY_BUILD_BATCH_SIZE 8 UNITY_BUILD_UNIQUE_ID hybridtest_unity_id)
endfunction()

# hybridtest_library(<name> [EXPORT <set>] [SOURCES <files>…] [PUBLIC <targets>…] [PRIVATE <targets>…])
#
# A static library of this folder: the SOURCES or, without them, all .cpp files below it but main.cpp. Targets whose
# headers its own headers include are PUBLIC. With EXPORT it is installed with its headers as hybridtest::<name>; a
# subfolder with a CMakeLists.txt is another target, and its headers are not installed with this one.
function(hybridtest_library name)
  cmake_parse_arguments(ARG "" "EXPORT" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target hybridtest_${name})
  if(NOT ARG_SOURCES)
    file(GLOB_RECURSE ARG_SOURCES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
    list(FILTER ARG_SOURCES EXCLUDE REGEX "/main\\.cpp$")
  endif()
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(hybridtest::${name} ALIAS ${target})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  hybridtest_compile(${target} hybridtest_precompiled)
  if(ARG_EXPORT)
    file(GLOB_RECURSE headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.hpp)
    file(GLOB other_targets RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/*/CMakeLists.txt)
    foreach(other ${other_targets})
      cmake_path(GET other PARENT_PATH folder)
      list(FILTER headers EXCLUDE REGEX "^${CMAKE_CURRENT_SOURCE_DIR}/${folder}/")
    endforeach()
    target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${headers})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
    set_property(GLOBAL APPEND PROPERTY hybridtest_public_headers ${headers})
    set_property(GLOBAL APPEND PROPERTY hybridtest_exported_targets ${target})
    if(HYBRIDTEST_INSTALL)
      install(TARGETS ${target} EXPORT ${ARG_EXPORT}
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hybridtest COMPONENT development)
    endif()
  else()
    target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  endif()
endfunction()

# hybridtest_embed_files(<target> <name> <files>…): the files become part of the target, which declares
# `std::span<const EmbeddedFile> hybridtest::embedded::<name>()` where it uses them (core/embedded_file.hpp).
function(hybridtest_embed_files target name)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/embedded_${name}.cpp)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ REGEX "^[^/]" OUTPUT_VARIABLE files)
  list(JOIN files "|" joined)
  add_custom_command(OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -D NAME=${name} "-DFILES=${joined}" -D OUTPUT=${source}
      -P ${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake
    COMMENT "Files for ${name}" VERBATIM)
  set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  target_sources(${target} PRIVATE ${source})
endfunction()

# hybridtest_program(<name> [INSTALL] SOURCES <files>… LINK <targets>…): in bin/ of the build folder.
function(hybridtest_program name)
  cmake_parse_arguments(ARG "INSTALL" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${ARG_LINK})
  hybridtest_compile(${name} hybridtest_precompiled)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  if(ARG_INSTALL AND HYBRIDTEST_INSTALL)
    install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
  endif()
endfunction()
