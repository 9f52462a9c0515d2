#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "recording/run_file_reader.hpp"

namespace hybridtest {

/// A run directory, read back.
class RecordedRun {
 public:
  explicit RecordedRun(std::filesystem::path directory) : directory_{std::move(directory)} {}

  [[nodiscard]] const std::filesystem::path& directory() const noexcept { return directory_; }
  [[nodiscard]] std::filesystem::path file(std::string_view participant) const;
  [[nodiscard]] RunFileReader open(std::string_view participant) const { return RunFileReader{file(participant)}; }
  /// @throws nlohmann::json::exception when `summary.json` is missing or not JSON.
  [[nodiscard]] nlohmann::json summary() const;
  [[nodiscard]] std::vector<double> column(std::string_view participant, std::string_view table,
                                           std::string_view name) const;
  /// Newest step in the participant's table `steps`, as far as it is in the file; -1 when there is none.
  [[nodiscard]] double last_step(std::string_view participant) const;
  /// The events that the participant itself raised with this code.
  [[nodiscard]] std::vector<Event> events(std::string_view participant, EventCode code) const;

 private:
  std::filesystem::path directory_;
};

}  // namespace hybridtest
