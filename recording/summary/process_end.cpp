#include "recording/summary/process_end.hpp"

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

namespace hybridtest {
namespace {

constexpr const char* kFile = "processes.json";
constexpr int kSignalsFrom = 128;
constexpr int kSignals = 64;

}  // namespace

void ProcessEnd::take_code_of_ssh(int code) noexcept {
  exit_code = code;
  if (code > kSignalsFrom && code <= kSignalsFrom + kSignals) signal = code - kSignalsFrom;
}

bool ProcessEnd::has_lost_connection() const noexcept {
  return !host.empty() && signal == 0 && exit_code == kSshFailed;
}

std::string ProcessEnd::text() const {
  if (has_lost_connection()) {
    return "the ssh connection to " + host + " was lost, so it was told to stop" + (words.empty() ? "" : ": " + words);
  }
  if (signal != 0) return "killed by signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
  return words.empty() ? "ended with exit code " + std::to_string(exit_code) : words;
}

void write_process_ends(const std::vector<ProcessEnd>& ends, const std::filesystem::path& run_directory) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ProcessEnd& end : ends) {
    list.push_back({{"participant", end.participant},
                    {"exit_code", end.exit_code},
                    {"signal", end.signal},
                    {"words", end.words},
                    {"was_asked", end.was_asked},
                    {"before_start", end.before_start},
                    {"host", end.host}});
  }
  std::ofstream{run_directory / kFile} << list.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
                                       << '\n';
}

std::vector<ProcessEnd> read_process_ends(const std::filesystem::path& run_directory) {
  std::ifstream file{run_directory / kFile};
  const auto list = nlohmann::json::parse(file, nullptr, false);
  if (!list.is_array()) return {};
  std::vector<ProcessEnd> ends;
  try {
    for (const auto& entry : list) {
      ends.push_back({entry.at("participant"), entry.at("exit_code"), entry.at("signal"), entry.at("words"),
                      entry.at("was_asked"), entry.at("before_start"), entry.value("host", "")});
    }
  } catch (const nlohmann::json::exception&) {
    return {};
  }
  return ends;
}

}  // namespace hybridtest
