#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/intake/intake.hpp"
#include "diagnosis/recording.hpp"
#include "diagnosis/structure/structure_diagnosis.hpp"
#include "diagnosis/test_response.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// The id of the site that is meant: `site`, or that of the run's only one where it is empty.
/// @throws ConfigError as raw_recording_of_run().
[[nodiscard]] std::string site_of_run(const std::filesystem::path& run, std::string_view site);

/// The run file of a site. @throws ConfigError as raw_recording_of_run().
[[nodiscard]] std::filesystem::path site_run_file(const std::filesystem::path& run, std::string_view site);

/// What a site recorded in a run, and what was sent to it; see read_recording().
/// @throws ConfigError when there is no such site, or several and none was named, or records are missing.
[[nodiscard]] RawRecording raw_recording_of_run(const std::filesystem::path& run, std::string_view site);

/// Reads and checks a recording for the diagnosis: a CSV file (see read_csv_recording()) or a run directory.
///
/// Of a run directory the site's control table is read, one sample per control period, and from the
/// coordinator's steps what it sent: continued between steps by a cubic through displacement and
/// velocity, as the site's trajectory does, in site time from the first step on. A run whose
/// coordinator left no file is read without it. It ends with the last target: how the site then returns to rest is no
/// part of the test. The hash is that of the CSV, or of the site's run file.
/// @param site   id of the substructure; may be empty where the run has one site, and has no meaning for a CSV.
/// @throws ConfigError when it cannot be read, and with every finding of the intake.
[[nodiscard]] Recording read_recording(const std::filesystem::path& path, RecordingRole role,
                                       std::string_view site = {});

/// The response that the coordinator of a run recorded, one column per completed step.
/// @throws RecordingError when there is no such record, or of other degrees of freedom.
[[nodiscard]] TestResponse recorded_response(const std::filesystem::path& run, const Scenario& scenario);

/// Likewise from the columns of its table `steps`, wherever they are.
/// @param column   all values under a column's name.
[[nodiscard]] TestResponse response_of_steps(const Scenario& scenario,
                                             const std::function<std::vector<double>(const std::string&)>& column);

/// The computed part of a test, as a scenario has it and as a run recorded it.
struct StructureRecord {
  ComputedStructure model;
  StructureRecording recording;
  std::vector<std::string> notes;  // what differs besides, and what was not recorded
};

/// @param scenario   the user's; of the same degrees of freedom and substructures as the run's own.
/// @throws ConfigError when they are not. @throws RecordingError when the coordinator's record is not there.
[[nodiscard]] StructureRecord structure_record(const std::filesystem::path& run, const Scenario& scenario);

}  // namespace hybridtest
