# Runs in every build: writes the source that names version and commit, and leaves it alone while they are the same.
#
#   cmake -D SOURCE=<checkout> -D INPUT=<version.cpp.in> -D OUTPUT=<version.cpp> -D HYBRIDTEST_VERSION=<x.y.z> -P write_version.cmake
set(HYBRIDTEST_COMMIT unknown)
find_program(GIT git)
if(GIT)
  # A repository above the checkout is another project's. A checkout of another owner, as in a container, is read too.
  cmake_path(GET SOURCE PARENT_PATH above)
  set(ENV{GIT_CEILING_DIRECTORIES} ${above})
  # Beside a git command of the developer, no lock is taken.
  set(ENV{GIT_OPTIONAL_LOCKS} 0)
  execute_process(
    COMMAND ${GIT} -c safe.directory=${SOURCE} -C ${SOURCE} describe --always --exclude=* --abbrev=12 --dirty
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE result)
  if(result EQUAL 0 AND commit)
    set(HYBRIDTEST_COMMIT ${commit})
  endif()
endif()
configure_file(${INPUT} ${OUTPUT} @ONLY)
