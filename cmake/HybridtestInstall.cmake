# What is installed, and the two Debian packages made of it:
#
#   hybridtest          component `programs`: the four programs and the shipped scenarios
#   libhybridtest-dev   component `development`: static libraries, headers, CMake package
#
# hybridtest_library() and hybridtest_program() install the targets themselves.

include(CMakePackageConfigHelpers)

set(package_directory ${CMAKE_INSTALL_LIBDIR}/cmake/hybridtest)
set(hybridtest_diagnosis_component "")
install(EXPORT hybridtestLibraries NAMESPACE hybridtest:: DESTINATION ${package_directory} COMPONENT development)
if(HYBRIDTEST_DIAGNOSIS)
  set(hybridtest_diagnosis_component " diagnosis")
  install(EXPORT hybridtestDiagnosis NAMESPACE hybridtest:: DESTINATION ${package_directory} COMPONENT development)
endif()
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/hybridtestConfig.cmake.in
  ${PROJECT_BINARY_DIR}/cmake/hybridtestConfig.cmake
  INSTALL_DESTINATION ${package_directory} NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
# Before 1.0 another minor version may have another interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cmake/hybridtestConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/cmake/hybridtestConfig.cmake ${PROJECT_BINARY_DIR}/cmake/hybridtestConfigVersion.cmake
  DESTINATION ${package_directory} COMPONENT development)

if(HYBRIDTEST_FAST_DDS)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/launch/scenarios ${PROJECT_SOURCE_DIR}/launch/profiles DESTINATION ${CMAKE_INSTALL_DATADIR}/hybridtest
    COMPONENT programs)
  install(PROGRAMS ${PROJECT_SOURCE_DIR}/launch/security/make_credentials
    DESTINATION ${CMAKE_INSTALL_DATADIR}/hybridtest/security COMPONENT programs)
  install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/hybridtest COMPONENT programs)
endif()

# CPack.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR "the hybridtest maintainers")
set(CPACK_PACKAGE_CONTACT "hybridtest maintainers <maintainers@hybridtest.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "middleware for distributed hybrid tests over DDS")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL development)
if(HYBRIDTEST_FAST_DDS)
  list(APPEND CPACK_COMPONENTS_ALL programs)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)

set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME hybridtest)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SUGGESTS "openssl")
set(CPACK_COMPONENT_PROGRAMS_DESCRIPTION
"Part of a structure is computed, the part that cannot be modelled well stands in
a laboratory as a specimen. In every step, actuators push the specimen to the
computed displacement, and the measured force goes back into the equation of
motion. The processes run on one machine or on several hosts, and a simulated
rig can replace a laboratory.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libhybridtest-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4)")
# For the component diagnosis alone.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "libceres-dev, libfmt-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
"Delay compensators, structures and constitutive laws, models of transfer
systems, sensors and specimens, and the diagnosis of the gap between a recorded
test and its model: static libraries, headers and a CMake package.")
include(CPack)

# `package`, CPack's own target, builds everything first, tests included; this one builds what it packs.
add_custom_target(debian_package
  COMMAND ${CMAKE_CPACK_COMMAND} --config ${PROJECT_BINARY_DIR}/CPackConfig.cmake
  USES_TERMINAL COMMENT "Packing the Debian packages into ${PROJECT_BINARY_DIR}/packages")
get_property(libraries GLOBAL PROPERTY hybridtest_exported_targets)
add_dependencies(debian_package ${libraries})
if(HYBRIDTEST_FAST_DDS)
  add_dependencies(debian_package programs)
endif()
