#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "core/text/scalar.hpp"
#include "tests/support/opensees.hpp"
#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// The real OpenSees leads a test: it integrates, the substructures of the test are its genericClient elements.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

/// A port that nothing listens on.
int free_port() {
  const int socket_number = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  bind(socket_number, reinterpret_cast<const sockaddr*>(&address), size);
  getsockname(socket_number, reinterpret_cast<sockaddr*>(&address), &size);
  close(socket_number);
  return ntohs(address.sin_port);
}

/// Columns of a file that OpenSees recorded: time, then displacements.
std::vector<std::vector<double>> columns_of(const std::filesystem::path& file) {
  std::vector<std::vector<double>> columns;
  std::ifstream text{file};
  for (std::string line; std::getline(text, line);) {
    std::istringstream words{line};
    std::size_t column = 0;
    for (double value = 0.0; words >> value; ++column) {
      if (column == columns.size()) columns.emplace_back();
      columns[column].push_back(value);
    }
  }
  return columns;
}

double peak_of(const std::vector<double>& values) {
  double peak = 0.0;
  for (const double value : values) peak = std::max(peak, std::abs(value));
  return peak;
}

/// Largest difference over the largest value.
double peak_error(const std::vector<double>& values, const std::vector<double>& reference) {
  double error = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i) error = std::max(error, std::abs(values.at(i) - reference[i]));
  return error / peak_of(reference);
}

class OpenSeesLeads : public SystemTest {
 protected:
  /// A copy of files in launch/scenarios/opensees, at ports of this test alone.
  std::filesystem::path own_copy(const std::string& name) {
    const std::filesystem::path from = shipped_scenario("opensees/" + name).parent_path();
    std::filesystem::create_directories(directory() / "opensees");
    std::filesystem::create_directory_symlink(from.parent_path() / "ground_motions", directory() / "ground_motions");
    for (const char* extension : {".yaml", ".tcl"}) write(name + extension, text_of(from / (name + extension)));
    return directory() / "opensees" / (name + ".yaml");
  }
  void write(const std::string& name, std::string text) {
    for (const std::string shipped : {"8090", "8091"}) {
      if (!ports_.contains(shipped)) ports_[shipped] = std::to_string(free_port());
      replace_all(text, shipped, ports_[shipped]);
    }
    std::ofstream{directory() / "opensees" / name} << text;
  }
  void change(const std::string& name, const std::string& from, const std::string& to) {
    std::string text = text_of(directory() / "opensees" / name);
    ASSERT_THAT(text, HasSubstr(from));
    replace_all(text, from, to);
    std::ofstream{directory() / "opensees" / name} << text;
  }
  static void replace_all(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
  }
  /// The same model with everything in OpenSees; its results are in this test's folder.
  void run_unsplit(const std::string& script, const Arguments& more = {}) {
    Arguments arguments{script, "unsplit"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    StartedProgram unsplit{test_opensees(), arguments, directory() / "unsplit", {.working_directory = directory() / "opensees"}};
    ASSERT_THAT(unsplit.wait(), Optional(0)) << unsplit.standard_error();
  }
  [[nodiscard]] int port() const { return std::stoi(ports_.at("8090")); }
  /// The process of OpenSees below `hybridtest run`; 0 when there is none.
  static pid_t opensees_of(const StartedProgram& run) {
    const pid_t coordinator = participant_of(run, kCoordinatorId);
    if (coordinator == 0) return 0;
    std::ifstream children{"/proc/" + std::to_string(coordinator) + "/task/" + std::to_string(coordinator) + "/children"};
    pid_t child = 0;
    return children >> child ? child : 0;
  }

  std::map<std::string, std::string> ports_;
};

TEST_F(OpenSeesLeads, LinearFrameIsTheUnsplitOne) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const std::filesystem::path scenario = own_copy("shear_frame");
  StartedProgram run = start_run(scenario, "run", {"--set", "substructures[storey_1].rig.specimen={type: elastic, stiffness_n_per_m: 4.0e6}"});
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  run_unsplit("shear_frame.tcl");
  const auto split = columns_of(directory() / "run" / "floors.txt");
  const auto whole = columns_of(directory() / "opensees" / "floors.txt");
  ASSERT_EQ(split.size(), 3U);
  ASSERT_EQ(split[1].size(), 31000U);
  // The same method with the same stiffness: the order of additions alone differs. Asked for: 5e-4.
  EXPECT_LT(peak_error(split[1], whole[1]), 1e-9);
  EXPECT_LT(peak_error(split[2], whole[2]), 1e-9);
}

}  // namespace
}  // namespace hybridtest
