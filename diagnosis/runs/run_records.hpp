#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/intake/intake.hpp"
#include "diagnosis/recording.hpp"
#include "diagnosis/structure/structure_diagnosis.hpp"
#include "diagnosis/test_response.hpp"
#include "scenario/scenario.hpp"
#include "scenario/site_model_file.hpp"

namespace hybridtest {

/// The id of the requested site: `site`, or the only site of the run if `site` is empty.
/// @throws ConfigError as raw_recording_of_run().
[[nodiscard]] std::string site_of_run(const std::filesystem::path& run, std::string_view site);

/// The model of a site, to be compared with these recordings of it. A site file that names no compensator takes that of
/// the run directories among them: a run directory says which compensator made the recorded commands, and a diagnosis
/// without it would find it as a cause.
/// @param site   id of the substructure; empty where scenario and run have one site.
/// @throws ConfigError as read_site_model() and site_of_run(), and when the compensators of the runs differ.
[[nodiscard]] SiteModelFile read_model_for(std::span<const std::filesystem::path> recordings,
                                           const std::filesystem::path& model, std::string_view site);

/// The run file of a site. @throws ConfigError as raw_recording_of_run().
[[nodiscard]] std::filesystem::path site_run_file(const std::filesystem::path& run, std::string_view site);

/// The recording of a site in a run and the displacements sent to it; see read_recording().
/// @throws ConfigError when there is no such site, or several and none was named, or records are missing.
[[nodiscard]] RawRecording raw_recording_of_run(const std::filesystem::path& run, std::string_view site);

/// Reads and checks a recording for the diagnosis: a CSV file (see read_csv_recording()) or a run directory.
///
/// From a run directory it reads the control table of the site, one sample per control period, and the
/// displacements that the coordinator sent. Between steps these follow a cubic through displacement and velocity,
/// like the trajectory of the site, in site time from the first step. Without a file of the coordinator they are
/// omitted. The recording ends with the last target: the return to rest after it is not part of the test. The hash
/// is that of the CSV file, or of the run file of the site.
/// @param site   id of the substructure; may be empty where the run has one site, and has no meaning for a CSV.
/// @param time   quasi_static: its time stamps have no meaning, as the model's file says.
/// @throws ConfigError when it cannot be read, and with every finding of the intake.
[[nodiscard]] Recording read_recording(const std::filesystem::path& path, RecordingRole role,
                                       std::string_view site = {}, TimeBase time = TimeBase::recorded);

/// The response that the coordinator of a run recorded, one column per completed step.
/// @throws RecordingError when there is no such record, or of other degrees of freedom.
[[nodiscard]] TestResponse recorded_response(const std::filesystem::path& run, const Scenario& scenario);

/// The same from the columns of a table `steps` that is not in a file.
/// @param column   all values under a column's name.
[[nodiscard]] TestResponse response_of_steps(const Scenario& scenario,
                                             const std::function<std::vector<double>(const std::string&)>& column);

/// The computed part of a test, as the scenario describes it and as the run recorded it.
struct StructureRecord {
  ComputedStructure model;
  StructureRecording recording;
  std::vector<std::string> notes;  // other differences, and missing recordings
};

/// @param scenario   the user's; of the same degrees of freedom and substructures as the run's own.
/// @throws ConfigError when they are not. @throws RecordingError when the coordinator's record is not there.
[[nodiscard]] StructureRecord structure_record(const std::filesystem::path& run, const Scenario& scenario);

}  // namespace hybridtest
