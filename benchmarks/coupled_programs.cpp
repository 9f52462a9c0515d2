#include "benchmarks/coupled_programs.hpp"

#include <unistd.h>

#include <memory>
#include <stdexcept>

#include "core/child_process.hpp"
#include "recording/run_file_reader.hpp"

namespace hybridtest::benchmarks {

std::vector<double> coupled_step_us(const std::filesystem::path& scenario, const std::vector<std::string>& ids,
                                    int warm_up, unsigned domain, const std::vector<std::string>& further,
                                    const std::filesystem::path& credentials) {
  const std::filesystem::path out =
      std::filesystem::temp_directory_path() / ("coupled_step_" + std::to_string(getpid()));
  std::filesystem::remove_all(out);
  std::filesystem::create_directories(out);
  const std::filesystem::path programs{HYBRIDTEST_PROGRAM_DIR};
  std::vector<std::string> arguments{"--scenario", scenario.string(),      "--out",          out.string(),
                                     "--domain",   std::to_string(domain), "--loopback-only"};
  arguments.insert(arguments.end(), further.begin(), further.end());
  std::vector<std::unique_ptr<ChildProcess>> children;
  const auto start = [&](const std::string& id, const char* program, std::vector<std::string> its_arguments) {
    if (!credentials.empty()) its_arguments.insert(its_arguments.end(), {"--credentials", (credentials / id).string()});
    children.push_back(std::make_unique<ChildProcess>(id, ChildStart{.program = programs / program,
                                                                     .arguments = std::move(its_arguments),
                                                                     .log_file = out / (id + ".log"),
                                                                     .is_killed_with_parent = true}));
  };
  start("coordinator", "coordinator", arguments);
  for (const std::string& id : ids) {
    std::vector<std::string> with_id = arguments;
    with_id.insert(with_id.end(), {"--id", id});
    start(id, "numerical_substructure", with_id);
  }
  for (const auto& child : children) {
    while (child->is_running()) usleep(20'000);
    if (child->exit_code() != 0) {
      throw std::runtime_error{child->id() + " failed; see " + child->log_file().string()};
    }
  }
  const std::vector<double> wall_s = RunFileReader{out / "coordinator.h5"}.column("steps", "wall_time_s");
  std::vector<double> times_us;
  for (auto i = static_cast<std::size_t>(warm_up) + 1; i < wall_s.size(); ++i) {
    times_us.push_back((wall_s[i] - wall_s[i - 1]) * 1e6);
  }
  std::filesystem::remove_all(out);
  return times_us;
}

}  // namespace hybridtest::benchmarks
