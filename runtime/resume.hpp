#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "coordinator/coordinator.hpp"
#include "core/time.hpp"
#include "numerical_substructure/numerical_node.hpp"
#include "recording/recorder.hpp"
#include "recording/run_file_reader.hpp"
#include "scenario/scenario.hpp"

/// Going on with a test whose coordinator died, from its recording. See docs/resume.md.
namespace hybridtest {

/// The file of a participant that died, moved out of the way of its successor: `before_<n>/<participant>.h5` in the run
/// directory. It moves back unless the successor has taken over its rows.
class FileSetAside {
 public:
  /// @throws ConfigError when it cannot be moved. A file that is not there is no error.
  FileSetAside(const std::filesystem::path& run_directory, std::string_view participant);
  ~FileSetAside();
  FileSetAside(const FileSetAside&) = delete;
  FileSetAside& operator=(const FileSetAside&) = delete;

  void keep() noexcept { is_kept_ = true; }

 private:
  std::filesystem::path file_;
  std::filesystem::path aside_;  // empty where there was no file
  bool is_kept_ = false;
};

/// The recording of the test's coordinators so far that has the most answers.
/// @throws ConfigError when there is none.
[[nodiscard]] RunFileReader interrupted_recording(const std::filesystem::path& run_directory);

/// @throws ConfigError, in words, when the test in this directory is not one that can go on.
void require_resumable(const std::filesystem::path& run_directory, const Scenario& scenario);

/// The table `answers`, command by command. One that was not recorded completely is left out, and what follows.
/// @param visit   returns false to end.
void read_answers(const RunFileReader& file, const std::vector<Eigen::Index>& interface_sizes,
                  const std::function<bool(const AnsweredCommand&)>& visit);

/// Brings a new coordinator to the end of the recording, and its own recording to the rows of that one.
/// @param before             recording of the coordinator that died.
/// @param first_coordinator  of the test.
/// @param clock_zero_unix_s  of this process.
/// @throws ConfigError when it computes anything else than the recording has, in any bit.
void restore_coordinator(Coordinator& coordinator, const Scenario& scenario, const RunFileReader& before,
                         Incarnation first_coordinator, Recorder& recorder, double clock_zero_unix_s);
/// The first coordinator of the test in this directory, of which `newest` is the recording that goes furthest.
[[nodiscard]] Incarnation first_coordinator(const std::filesystem::path& run_directory, const RunFileReader& newest);

/// Brings a new numerical substructure to the end of the recording: its forces must be those that the coordinator
/// recorded, bit for bit.
/// @throws ConfigError otherwise, and for a model that computes outside its process.
void restore_numerical(NumericalNode& node, const Scenario& scenario, const SubstructureScenario& substructure,
                       const RunFileReader& before, Recorder& recorder);

}  // namespace hybridtest
