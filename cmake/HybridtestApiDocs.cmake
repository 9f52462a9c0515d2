# The target `api_docs`: pages of the installed headers, made of their docstrings. A warning of Doxygen is an error.

find_program(DOXYGEN doxygen)
set(API_DOCS_DIRECTORY ${PROJECT_BINARY_DIR}/api_docs)
get_property(headers GLOBAL PROPERTY hybridtest_public_headers)
list(TRANSFORM headers REPLACE "(.+)" "\"\\1\"")
list(JOIN headers " " API_DOCS_INPUT)
configure_file(${PROJECT_SOURCE_DIR}/docs/Doxyfile.in ${API_DOCS_DIRECTORY}/Doxyfile @ONLY)
if(DOXYGEN)
  add_custom_target(api_docs COMMAND ${DOXYGEN} ${API_DOCS_DIRECTORY}/Doxyfile COMMENT "API pages" VERBATIM)
else()
  add_custom_target(api_docs COMMAND ${CMAKE_COMMAND} -E echo "api_docs: doxygen is not installed"
    COMMAND ${CMAKE_COMMAND} -E false)
endif()
