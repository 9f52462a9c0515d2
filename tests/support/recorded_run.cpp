#include "tests/support/recorded_run.hpp"

#include "recording/error.hpp"
#include "recording/run_file.hpp"
#include "tests/support/started_program.hpp"

namespace hybridtest {

std::filesystem::path RecordedRun::file(std::string_view participant) const {
  return directory_ / (std::string{participant} + std::string{kRunFileExtension});
}

nlohmann::json RecordedRun::summary() const { return nlohmann::json::parse(text_of(directory_ / "summary.json")); }

std::vector<double> RecordedRun::column(std::string_view participant, std::string_view table,
                                        std::string_view name) const {
  return open(participant).column(table, name);
}

double RecordedRun::last_step(std::string_view participant) const try {
  const RunFileReader run_file = open(participant);
  const std::vector<double> steps = run_file.column("steps", "step");
  return steps.empty() ? -1.0 : steps.back();
} catch (const RecordingError&) {
  return -1.0;  // not made yet
}

std::vector<Event> RecordedRun::events(std::string_view participant, EventCode code) const {
  std::vector<Event> found;
  for (const RecordedEvent& recorded : open(participant).events()) {
    if (recorded.event.code == code) found.push_back(recorded.event);
  }
  return found;
}

}  // namespace hybridtest
