#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "diagnosis/recording.hpp"

namespace hybridtest {

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

}  // namespace hybridtest
