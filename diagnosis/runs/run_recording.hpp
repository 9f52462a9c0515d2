#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "diagnosis/intake/raw_recording.hpp"

namespace hybridtest {

/// The id of the site that is meant: `site`, or that of the run's only one where it is empty.
/// @throws ConfigError as raw_recording_of_run().
[[nodiscard]] std::string site_of_run(const std::filesystem::path& run, std::string_view site);

/// The run file of a site. @throws ConfigError as raw_recording_of_run().
[[nodiscard]] std::filesystem::path site_run_file(const std::filesystem::path& run, std::string_view site);

/// What a site recorded in a run, and what was sent to it; see read_recording().
/// @throws ConfigError when there is no such site, or several and none was named, or records are missing.
[[nodiscard]] RawRecording raw_recording_of_run(const std::filesystem::path& run, std::string_view site);

}  // namespace hybridtest
