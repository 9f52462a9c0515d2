#include "diagnosis/runs/read_recording.hpp"

#include <fstream>
#include <iterator>
#include <utility>

#include "core/config_error.hpp"
#include "diagnosis/intake/intake.hpp"
#include "diagnosis/runs/run_recording.hpp"
#include "recording/run_file.hpp"
#include "scenario/scenario_digest.hpp"

namespace hybridtest {
namespace {

/// A file beyond this is no recording of one test; it would not fit into memory as text and numbers.
constexpr std::uintmax_t kLargestFile_bytes = std::uintmax_t{1} << 31U;

std::string content_of(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw ConfigError{path.string() + ": cannot be read (" + error.message() + ")"};
  if (size > kLargestFile_bytes) throw ConfigError{path.string() + ": larger than 2 GiB"};
  std::ifstream stream{path, std::ios::binary};
  std::string text{std::istreambuf_iterator<char>{stream}, std::istreambuf_iterator<char>{}};
  if (!stream || text.size() != size) throw ConfigError{path.string() + ": cannot be read"};
  return text;
}

Recording accepted(Intake intake, const std::string& file) {
  if (intake.recording) return std::move(*intake.recording);
  std::vector<ConfigIssue> issues;
  // Rows are shown as lines are; the text of a finding has its place already.
  for (const IntakeFinding& finding : intake.findings) issues.push_back({.file = {}, .what = finding.text(file)});
  throw ConfigError{std::move(issues)};
}

}  // namespace

Recording read_recording(const std::filesystem::path& path, RecordingRole role, std::string_view site) {
  const std::string file = path.string();
  Recording recording;
  if (std::filesystem::is_directory(path)) {
    recording = accepted(check_recording(raw_recording_of_run(path, site)), file);
    recording.sha256 = hex(sha256(content_of(site_run_file(path, site))));
  } else {
    const std::string text = content_of(path);
    recording = accepted(read_csv_recording(text, file), file);
    recording.sha256 = hex(sha256(text));
  }
  recording.role = role;
  return recording;
}

}  // namespace hybridtest
