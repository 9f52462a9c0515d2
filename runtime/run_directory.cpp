#include "runtime/run_directory.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <fstream>
#include <system_error>

#include "core/config_error.hpp"
#include "runtime/version.hpp"

namespace hybridtest {
namespace {

std::string utc_text(const char* format) {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts{};
  gmtime_r(&now, &parts);
  std::array<char, 64> text{};
  std::strftime(text.data(), text.size(), format, &parts);
  return text.data();
}

void copy_named_files(const std::filesystem::path& directory, const Scenario& scenario) {
  for (const NamedFile& named : scenario.files) {
    const std::filesystem::path written{named.written};
    if (written.is_absolute() || written.lexically_normal().string().starts_with("..")) continue;
    const std::filesystem::path target = directory / written;
    std::filesystem::create_directories(target.parent_path());
    if (!std::filesystem::exists(target)) {
      std::filesystem::copy_file(named.file, target, std::filesystem::copy_options::skip_existing);
    }
  }
}

}  // namespace

std::string time_utc() { return utc_text("%Y-%m-%dT%H:%M:%SZ"); }

std::filesystem::path default_run_directory(std::string_view test_name) {
  return std::filesystem::path{"runs"} / (std::string{test_name} + "_" + utc_text("%Y%m%dT%H%M%SZ"));
}

void prepare_run_directory(const std::filesystem::path& directory, const Scenario& scenario) try {
  std::filesystem::create_directories(directory);
  const std::filesystem::path file = directory / "scenario.yaml";
  copy_named_files(directory, scenario);
  // Participants on one machine share the directory; each writes the same bytes.
  const std::filesystem::path partial =
      directory / ("." + std::to_string(scenario.digest[0]) + "." + std::to_string(::getpid()) + ".scenario.yaml");
  std::ofstream text{partial};
  text << scenario.effective;
  if (!text.flush()) {
    const std::error_code error{errno == 0 ? EIO : errno, std::generic_category()};
    std::filesystem::remove(partial);
    throw std::filesystem::filesystem_error{"", partial, error};
  }
  std::filesystem::rename(partial, file);
} catch (const std::filesystem::filesystem_error& error) {
  throw ConfigError{"--out " + directory.string() + ": cannot write there: " + error.code().message()};
}

void require_new_run(const std::filesystem::path& directory, std::string_view participant) {
  if (!std::filesystem::exists(run_file(directory, participant))) return;
  throw ConfigError{"--out " + directory.string() + ": '" + std::string{participant} +
                    "' has already recorded a run in this directory; choose another one"};
}

std::filesystem::path run_file(const std::filesystem::path& directory, std::string_view participant) {
  return directory / (std::string{participant} + std::string{kRunFileExtension});
}

RunFileHeader run_file_header(const Scenario& scenario, std::string_view participant, Role role,
                              Incarnation incarnation) {
  RunFileHeader header;
  header.participant = participant;
  header.role = role;
  header.test_name = scenario.name;
  header.scenario_digest = scenario.digest;
  header.incarnation = incarnation;
  header.start_time_utc = time_utc();
  header.software_version = software_version();
  header.structure_dofs = scenario.recorded_names();
  for (const SubstructureScenario& substructure : scenario.substructures) {
    header.substructure_ids.push_back(substructure.id);
    if (substructure.id == participant) header.interface_dofs = substructure.interface_names;
  }
  return header;
}

TableLayout test_layout() {
  return {"test",
          {{"planned_steps", ""},
           {"completed_steps", ""},
           {"stop_reason", ""},
           {"wall_time_s", "s"},
           {"exit_code", ""},
           {"step_wall_time_s", "s"},
           {"ground_motion_peak_m_per_s2", "m/s2"},
           {"ground_motion_points", ""},
           {"ground_motion_duration_s", "s"}}};
}

std::vector<double> test_row(const Scenario& scenario, const CoordinatorReport& report, int exit_code) {
  // Step 0 is the initial state; it is not counted as a completed step.
  const Step taken = std::max<Step>(report.completed_steps - 1, 0);
  const bool is_paced = scenario.time.mode == CouplingMode::paced;
  const double step_wall_time_s = is_paced ? scenario.time.step_s * scenario.time.time_scale : 0.0;
  return {static_cast<double>(scenario.time.last_step),
          static_cast<double>(taken),
          static_cast<double>(report.reason),
          to_seconds(report.running_time),
          static_cast<double>(exit_code),
          step_wall_time_s,
          scenario.ground_motion.peak_m_per_s2,
          static_cast<double>(scenario.ground_motion.points),
          scenario.ground_motion.duration_s};
}

}  // namespace hybridtest
