#include "tests/support/programs_on_hosts.hpp"

#include <optional>

namespace hybridtest {

ProgramsOnHosts::ProgramsOnHosts(const EmulatedNetwork& network, const std::vector<ParticipantProgram>& programs,
                                 const std::filesystem::path& scenario, const std::filesystem::path& directory,
                                 const std::vector<std::string>& arguments)
    : directory_{directory} {
  for (std::size_t host = 0; host < programs.size(); ++host) {
    const ParticipantProgram& participant = programs[host];
    ids_.push_back(participant.id);
    std::vector<std::string> all{"--scenario", scenario.string(), "--out", (directory / participant.id).string()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    if (host > 0) all.insert(all.end(), {"--id", participant.id});
    for (std::size_t other = 0; other < programs.size(); ++other) {
      if (other != host) all.insert(all.end(), {"--peer", network.host(other).address()});
    }
    network.host(host).inside(
        [&] { programs_.emplace_back(participant.program, all, directory / (participant.id + ".output")); });
  }
}

std::vector<int> ProgramsOnHosts::wait(std::chrono::milliseconds patience) {
  std::vector<int> exit_codes;
  for (StartedProgram& program : programs_) exit_codes.push_back(program.wait(patience).value_or(-1));
  return exit_codes;
}

RecordedRun ProgramsOnHosts::collected() const {
  RecordedRun run{directory_ / ids_.front()};
  for (const std::string& id : ids_) {
    const std::filesystem::path file = RecordedRun{directory_ / id}.file(id);
    if (id != ids_.front() && std::filesystem::exists(file)) {
      std::filesystem::copy(file, run.directory(), std::filesystem::copy_options::overwrite_existing);
    }
  }
  return run;
}

std::string ProgramsOnHosts::messages() const {
  std::string text;
  for (std::size_t i = 0; i < programs_.size(); ++i) {
    text += "--- " + ids_[i] + '\n' + programs_[i].standard_error() + '\n';
  }
  return text;
}

}  // namespace hybridtest
