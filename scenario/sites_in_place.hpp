#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hybridtest {

/// Overrides, behind those given, that put the content of a site's file (see read_site_model()) where a
/// scenario names it: `rig: {type: simulated, model: FILE}`, and `model: FILE` beside a rig. Files are
/// looked for beside the scenario. So the effective scenario holds the models themselves: its digest
/// speaks for them, and a run directory needs no other file to be run again.
/// @throws ConfigError with everything wrong with such a file, when `model` shares a rig with other keys, or when a
///         file corrects the setting of another compensator than the site has.
[[nodiscard]] std::vector<std::string> with_sites_in_place(const std::filesystem::path& scenario,
                                                           std::vector<std::string> overrides);

}  // namespace hybridtest
