#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/child_process.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// Where a participant that `hybridtest run` starts over ssh runs: one entry of a host file.
struct RemoteHost {
  std::string id;  // of the substructure
  Role role = Role::experimental_site;
  std::string destination;             // as for `ssh`: user@host, or a name of its configuration
  std::string folder;                  // there, for the files of runs; without a '/' in front: below the home
  std::string programs;                // folder of the programs there; empty where they are in its PATH
  std::vector<std::string> arguments;  // further ones of the program there
};

/// A host file: which substructure runs on which host.
/// @throws ConfigError with every error of the file, and for an id that the scenario does not have.
[[nodiscard]] std::vector<RemoteHost> read_remote_hosts(const std::filesystem::path& file, const Scenario& scenario);

/// A participant on another host, reached by ssh: nobody is asked for a password. When the local ssh ends, for whatever
/// cause, the participant there is told to stop safely and, if it does not, killed.
class RemoteParticipant {
 public:
  /// @param run_name        folder of this run on the other host, below RemoteHost::folder.
  /// @param run_directory   local; with the scenario and its files, as prepare_run_directory() leaves them.
  RemoteParticipant(RemoteHost host, std::string run_name, std::filesystem::path run_directory);

  /// Makes its folder there, and copies the scenario, its files and the network profile.
  /// @param network_file   empty where there is none.
  /// @throws ConfigError when the host is not reached, the program is not there or has another version, or a copy
  ///         differs.
  void prepare(const Scenario& scenario, const std::filesystem::path& network_file);
  /// @param network_arguments   those of this process, without the profile.
  [[nodiscard]] std::unique_ptr<ChildProcess> start(const Scenario& scenario,
                                                    const std::vector<std::string>& network_arguments) const;
  /// Copies its recording into the local run directory.
  /// @return what went wrong and where the recording is; empty when it is here.
  [[nodiscard]] std::string fetch() const;

 private:
  struct Answer {
    int exit_code = 0;
    std::vector<std::string> lines;  // the last of its output
  };

  [[nodiscard]] Answer ssh(const std::string& script) const;
  [[nodiscard]] Answer scp(const std::vector<std::string>& arguments) const;
  [[nodiscard]] Answer run(const ChildStart& start) const;
  [[noreturn]] void refuse(const std::string& what) const;
  void require_program() const;
  void copy_there(const std::vector<std::string>& files, const std::filesystem::path& network_file);
  void require_same(const std::vector<std::string>& files) const;

  [[nodiscard]] std::string program() const;
  [[nodiscard]] std::string run_folder() const { return host_.folder + "/" + run_name_; }
  [[nodiscard]] std::filesystem::path log_file() const { return run_directory_ / (host_.id + ".log"); }

  RemoteHost host_;
  std::string run_name_;
  std::filesystem::path run_directory_;
  bool has_network_file_ = false;
  struct Pipe;
  std::shared_ptr<Pipe> input_;  // of the ssh that runs the participant; its end is the end of the participant
};

}  // namespace hybridtest
