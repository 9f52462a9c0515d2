#include "runtime/run_directory.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <system_error>

#include "coordinator/excitation/response_spectrum.hpp"
#include "core/config_error.hpp"
#include "mechanics/structure/vibration_modes.hpp"
#include "runtime/table_notes.hpp"
#include "runtime/version.hpp"

namespace hybridtest {
namespace {

std::time_t time_now() { return std::chrono::system_clock::to_time_t(std::chrono::system_clock::now()); }

std::string utc_text(const char* format, std::time_t seconds = time_now()) {
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 64> text{};
  std::strftime(text.data(), text.size(), format, &parts);
  return text.data();
}

/// With microseconds. @param unix_s   [s] since 1970-01-01T00:00:00Z.
std::string utc_text_of(double unix_s) {
  const auto us = static_cast<std::int64_t>(std::llround(unix_s * 1e6));
  std::array<char, 16> fraction{};
  std::snprintf(fraction.data(), fraction.size(), ".%06dZ", static_cast<int>(us % 1'000'000));
  return utc_text("%Y-%m-%dT%H:%M:%S", us / 1'000'000) + fraction.data();
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

std::string time_utc() { return time_utc_of(time_now()); }
std::string time_utc_of(std::time_t seconds) { return utc_text("%Y-%m-%dT%H:%M:%SZ", seconds); }

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
                              Incarnation incarnation, double clock_zero_unix_s) {
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
  header.t0_utc = utc_text_of(clock_zero_unix_s);
  header.t0_unix_s = clock_zero_unix_s;
  header.model_time_step_s = scenario.time.step_s;
  header.table_notes = table_notes(scenario, participant);
  return header;
}

namespace {

void write_test(const Scenario& scenario, const CoordinatorReport& report, int exit_code, RowSink& test) {
  // Step 0 is the initial state; it is not counted as a completed step.
  const Step taken = std::max<Step>(report.completed_steps - 1, 0);
  // Where OpenSees leads, its model says when the test is over.
  const bool is_over = scenario.opensees && report.reason == StopReason::completed;
  const Step planned = is_over ? taken : scenario.time.last_step;
  const bool is_paced = scenario.time.mode == CouplingMode::paced;
  const double step_wall_time_s = is_paced ? scenario.time.step_s * scenario.time.time_scale : 0.0;
  test.append(std::array{static_cast<double>(planned), static_cast<double>(taken), static_cast<double>(report.reason),
                         to_seconds(report.running_time), static_cast<double>(exit_code), step_wall_time_s});
}

/// Over the standard periods, and at those of the structure.
void write_spectra(const Scenario& scenario, RowSink& spectra) {
  if (scenario.excitation.records.empty()) return;
  const VibrationModes modes = vibration_modes(scenario.structure);
  const std::vector<double> periods_s = spectrum_periods_s();
  for (std::size_t k = 0; k < scenario.excitation.records.size(); ++k) {
    const GroundMotion motion =
        scenario.excitation.applied_motion(scenario.excitation.records[k], scenario.time.step_s);
    const auto write = [&](Eigen::Index mode, double period_s) {
      const SpectrumOrdinate at = spectrum_ordinate(motion, period_s, kSpectrumDamping);
      spectra.append(std::array{static_cast<double>(k + 1), static_cast<double>(mode), at.period_s, at.displacement_m,
                                at.velocity_m_per_s, at.pseudo_acceleration_m_per_s2});
    };
    for (const double period_s : periods_s) write(0, period_s);
    for (Eigen::Index mode = 0; mode < std::min(modes.count(), kLowestModes); ++mode) {
      if (std::isfinite(modes.period_s(mode))) write(mode + 1, modes.period_s(mode));
    }
  }
}

}  // namespace

std::vector<TableLayout> test_tables() {
  return {{"test",
           {{"planned_steps", ""},
            {"completed_steps", ""},
            {"stop_reason", ""},
            {"wall_time_s", "s"},
            {"exit_code", ""},
            {"step_wall_time_s", "s"}}},
          {"ground_motions",
           {{"record", ""},
            {"peak_m_per_s2", "m/s2"},
            {"points", ""},
            {"duration_s", "s"},
            {"factor", ""},
            {"end_velocity_m_per_s", "m/s"},
            {"end_displacement_m", "m"}}},
          {"response_spectra",
           {{"record", ""},
            {"mode", ""},
            {"period_s", "s"},
            {"displacement_m", "m"},
            {"velocity_m_per_s", "m/s"},
            {"pseudo_acceleration_m_per_s2", "m/s2"}}}};
}

void write_test_tables(const Scenario& scenario, const CoordinatorReport& report, int exit_code,
                       const std::function<RowSink&(std::string_view table)>& sink) {
  write_test(scenario, report, exit_code, sink("test"));
  RowSink& motions = sink("ground_motions");
  for (std::size_t k = 0; k < scenario.excitation.records.size(); ++k) {
    const GroundRecord& record = scenario.excitation.records[k];
    motions.append(std::array{static_cast<double>(k + 1), record.facts.peak_m_per_s2,
                              static_cast<double>(record.facts.points), record.facts.duration_s,
                              record.factor_found.value_or(std::numeric_limits<double>::quiet_NaN()),
                              record.end.velocity_m_per_s, record.end.displacement_m});
  }
  write_spectra(scenario, sink("response_spectra"));
}

}  // namespace hybridtest
