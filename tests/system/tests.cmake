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
# What the sanitized build runs, too, in a program of its own, so that the others need not be compiled for that. One of
# the tests compares what the builds simulate.
hybridtest_program(simulate_digest SOURCES system/simulate_digest/main.cpp LINK hybridtest_runtime)
string(TOUPPER "CMAKE_CXX_FLAGS_${CMAKE_BUILD_TYPE}" flags)
target_compile_definitions(simulate_digest PRIVATE HYBRIDTEST_COMPILED_WITH="${${flags}}")
hybridtest_test(system_every_build FOLDER system/every_build
  SOURCES ${support}/recorded_run.cpp ${support}/recording_checks.cpp ${support}/started_program.cpp
    ${support}/system_fixture.cpp
  LINK hybridtest_recording LABELS system PROPERTIES RUN_SERIAL TRUE TIMEOUT 300)
add_dependencies(system_every_build programs simulate_digest)
