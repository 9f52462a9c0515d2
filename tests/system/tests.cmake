# Whole tests in real processes, asserted on what they recorded.
hybridtest_test(system FOLDER system
  SOURCES ${support}/packet_fuzzer.cpp ${support}/recorded_run.cpp ${support}/recording_checks.cpp
    ${support}/reference_history.cpp ${support}/started_program.cpp ${support}/system_fixture.cpp
  LINK hybridtest_recording hybridtest_mechanics hybridtest_plotting hybridtest_httplib LABELS system
  # One at a time: they start processes, kill them and watch the time.
  PROPERTIES RUN_SERIAL TRUE TIMEOUT 300)
add_dependencies(system programs)
# The same as on several hosts: network profiles, doctor, participants that are started over ssh.
hybridtest_test(system_across_hosts FOLDER system/across_hosts
  SOURCES ${support}/recorded_run.cpp ${support}/started_program.cpp ${support}/system_fixture.cpp
  LINK hybridtest_recording nlohmann_json::nlohmann_json LABELS system PROPERTIES RUN_SERIAL TRUE TIMEOUT 300)
add_dependencies(system_across_hosts programs)
# Across emulated hosts, over networks that are bad.
hybridtest_test(system_bad_networks FOLDER system/bad_networks
  SOURCES ${support}/recorded_run.cpp ${support}/recording_checks.cpp ${support}/started_program.cpp
    ${support}/system_fixture.cpp ${support}/programs_on_hosts.cpp ${emulated_network}
  LINK hybridtest_recording LABELS system PROPERTIES RUN_SERIAL TRUE TIMEOUT 300)
add_dependencies(system_bad_networks programs)
# Intruders over DDS, in the same way.
hybridtest_test(system_security FOLDER system/security
  SOURCES ${support}/packet_fuzzer.cpp ${support}/recorded_run.cpp ${support}/started_program.cpp ${support}/system_fixture.cpp
  LINK hybridtest_recording hybridtest_transport_fast_dds nlohmann_json::nlohmann_json LABELS system
  PROPERTIES RUN_SERIAL TRUE TIMEOUT 300)
add_dependencies(system_security programs)
if(HYBRIDTEST_SANITIZE)
  return()  # What follows compares optimisation levels.
endif()

# The same simulation as this build compiles it, and without any optimisation.
hybridtest_program(simulate_digest SOURCES system/simulate_digest/main.cpp LINK hybridtest_runtime)
set(parts core config mechanics compensation plant coordinator numerical_substructure experimental_site transport
  recording scenario runtime)
foreach(part ${parts})
  get_target_property(sources hybridtest_${part} SOURCES)
  get_target_property(folder hybridtest_${part} SOURCE_DIR)
  foreach(source ${sources})
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${folder})
    list(APPEND part_sources ${source})
  endforeach()
endforeach()
add_executable(simulate_digest_unoptimised system/simulate_digest/main.cpp ${part_sources})
target_compile_features(simulate_digest_unoptimised PRIVATE cxx_std_20)
target_include_directories(simulate_digest_unoptimised PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(simulate_digest_unoptimised PRIVATE Eigen3::Eigen yaml-cpp HDF5::HDF5 nlohmann_json::nlohmann_json
  OpenSSL::Crypto Threads::Threads fmt::fmt hybridtest_version)
# After the build type's own flags, so these win.
target_compile_options(simulate_digest_unoptimised PRIVATE -O0 -UNDEBUG -g0)
set_target_properties(simulate_digest_unoptimised PROPERTIES
  RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin
  UNITY_BUILD ${HYBRIDTEST_UNITY_BUILD} UNITY_BUILD_BATCH_SIZE 4 UNITY_BUILD_UNIQUE_ID hybridtest_unity_id)
if(HYBRIDTEST_PRECOMPILED_HEADERS)
  target_precompile_headers(simulate_digest_unoptimised PRIVATE ${hybridtest_common_headers})
endif()
add_dependencies(system simulate_digest simulate_digest_unoptimised)
