# Pages in a real browser. The packages that they need belong to Debian's own Python.
find_program(HYBRIDTEST_DEBIAN_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
if(NOT HYBRIDTEST_DEBIAN_PYTHON)
  message(WARNING "no /usr/bin/python3: the pages are not tested")
  return()
endif()
file(GLOB web_tests CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/test_*.py)
foreach(file ${web_tests})
  cmake_path(GET file STEM name)
  string(REPLACE test_ web. test_name ${name})
  add_test(NAME ${test_name} COMMAND ${HYBRIDTEST_DEBIAN_PYTHON} -B -m unittest discover --verbose
    --start-directory ${CMAKE_CURRENT_LIST_DIR} --pattern ${name}.py)
  # One at a time: they start processes and watch the time.
  set_tests_properties(${test_name} PROPERTIES LABELS web RUN_SERIAL TRUE TIMEOUT 400
    SKIP_REGULAR_EXPRESSION "pages are not tested"
    ENVIRONMENT "HYBRIDTEST_PROGRAM_DIR=${PROJECT_BINARY_DIR}/bin;HYBRIDTEST_SOURCE_DIR=${PROJECT_SOURCE_DIR};HYBRIDTEST_WEB_OUTPUT=${PROJECT_BINARY_DIR}/web")
endforeach()
