#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/contract/opensees/bare_server.hpp"
#include "tests/contract/opensees/served_springs.hpp"
#include "tests/support/generic_client_bytes.hpp"
#include "tests/support/opensees.hpp"
#include "tests/support/started_program.hpp"

/// The integrators of the real OpenSees. docs/opensees.md has the table of them, and each row of it is run here.
namespace hybridtest {
namespace {

using testing::IsSupersetOf;
using testing::Optional;

constexpr double kFirstStorey = 4.0e6;
constexpr double kSecondStorey = 3.0e6;
constexpr std::size_t kSteps = 20;

/// Two storeys of 20 t under a ground motion of a sine. The folder has integrator.tcl; the results are floors.txt.
constexpr const char* kModel = R"(
set elements [lindex $argv 0]
model BasicBuilder -ndm 1 -ndf 1
node 0 0.0
node 1 0.0 -mass 20.0e3
node 2 0.0 -mass 20.0e3
fix 0 1
uniaxialMaterial Elastic 1 4.0e6
uniaxialMaterial Elastic 2 3.0e6
if {$elements > 0} {
  element genericClient 1 -node 1 -dof 1 -server [lindex $argv 1] 127.0.0.1 {*}[lrange $argv 3 end]
} else {
  element zeroLength 1 0 1 -mat 1 -dir 1
}
if {$elements > 1} {
  element genericClient 2 -node 1 2 -dof 1 -dof 1 -server [lindex $argv 2] 127.0.0.1 {*}[lrange $argv 3 end]
} else {
  element zeroLength 2 1 2 -mat 2 -dir 1
}
timeSeries Trig 1 0.0 10.0 0.5
pattern UniformExcitation 1 1 -accel 1
recorder Node -file floors.txt -precision 17 -time -node 1 2 -dof 1 disp
constraints Plain
numberer Plain
system FullGeneral
source integrator.tcl
analysis Transient
set failed [analyze 20 0.01]
wipe
exit $failed
)";

struct Row {
  std::string integrator;
  std::string commands;
  std::string step;
  std::string displacements;
};

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" `");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" `") - first + 1);
}

/// The table of integrators in docs/opensees.md.
std::vector<Row> documented_rows() {
  std::vector<Row> rows;
  std::ifstream page{std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "docs/opensees.md"};
  for (std::string line; std::getline(page, line);) {
    std::vector<std::string> cells;
    std::istringstream text{line};
    for (std::string cell; std::getline(text, cell, '|');) cells.push_back(trimmed(cell));
    if (cells.size() == 5 && cells[2].starts_with("algorithm "))
      rows.push_back({cells[1], cells[2], cells[3], cells[4]});
  }
  return rows;
}

class Integrators : public testing::Test {
 protected:
  void SetUp() override {
    HYBRIDTEST_NEEDS_OPENSEES();
    directory_ = std::filesystem::path{testing::TempDir()} /
                 (std::string{"opensees_"} + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(directory_);
    std::filesystem::create_directories(directory_);
    std::ofstream{directory_ / "model.tcl"} << kModel;
  }
  void use(const std::string& commands) const {
    std::string lines = commands;
    for (std::size_t at = lines.find(';'); at != std::string::npos; at = lines.find(';')) lines[at] = '\n';
    std::ofstream{directory_ / "integrator.tcl"} << lines << '\n';
  }
  StartedProgram start(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "model.tcl");
    return {test_opensees(), arguments, directory_ / "opensees", {.working_directory = directory_}};
  }
  /// Displacements of both floors, step after step; removes the file.
  std::vector<double> floors() const {
    std::vector<double> values;
    const std::filesystem::path file = directory_ / "floors.txt";
    std::ifstream text{file};
    for (double time = 0.0, first = 0.0, second = 0.0; text >> time >> first >> second;) {
      values.insert(values.end(), {first, second});
    }
    std::filesystem::remove(file);
    return values;
  }
  std::vector<double> unsplit() const {
    StartedProgram program = start({"0"});
    EXPECT_THAT(program.wait(), Optional(0)) << program.standard_error();
    return floors();
  }
  /// The first `elements` of the storeys are springs behind the server.
  std::vector<double> split(int elements, const std::vector<std::string>& options = {}) const {
    std::vector<Eigen::MatrixXd> stiffness{Eigen::MatrixXd::Constant(1, 1, kFirstStorey)};
    if (elements > 1) {
      stiffness.push_back(
          (Eigen::Matrix2d{} << kSecondStorey, -kSecondStorey, -kSecondStorey, kSecondStorey).finished());
    }
    ServedSprings springs{stiffness};
    std::vector<std::string> arguments{std::to_string(elements), std::to_string(springs.port(0)),
                                       std::to_string(elements > 1 ? springs.port(1) : 0)};
    arguments.insert(arguments.end(), options.begin(), options.end());
    StartedProgram program = start(arguments);
    EXPECT_TRUE(springs.answer_until(ElementRequest::Kind::die, elements)) << program.standard_error();
    EXPECT_THAT(program.wait(), Optional(0)) << program.standard_error();
    return floors();
  }
  static void expect_same(const std::vector<double>& values, const std::vector<double>& reference) {
    ASSERT_EQ(reference.size(), 2 * kSteps);
    ASSERT_EQ(values.size(), reference.size());
    double peak = 0.0;
    for (const double value : reference) peak = std::max(peak, std::abs(value));
    ASSERT_GT(peak, 0.01);
    // The order of additions alone differs.
    for (std::size_t i = 0; i < values.size(); ++i) ASSERT_NEAR(values[i], reference[i], 1e-13 * peak) << i;
  }

  std::filesystem::path directory_;
};

TEST_F(Integrators, OfTheDocsReproduceTheUnsplitModel) {
  for (const Row& row : documented_rows()) {
    SCOPED_TRACE(row.commands);
    use(row.commands);
    const std::vector<double> reference = unsplit();
    expect_same(split(1), reference);
    expect_same(split(2), reference);
  }
}

TEST_F(Integrators, OfTheDocsSayWhatTheDocsShow) {
  const std::vector<Row> rows = documented_rows();
  ASSERT_GE(rows.size(), 15U);
  for (const Row& row : rows) {
    use(row.commands);
    BareServer server{kFirstStorey};
    StartedProgram program = start({"1", std::to_string(server.port())});
    const std::vector<BareServer::Message> heard = server.heard();
    ASSERT_THAT(program.wait(), Optional(0)) << row.commands << program.standard_error();
    ASSERT_FALSE(heard.empty());
    EXPECT_EQ(heard.back().action, 99);
    // The third step: the first ones ask more.
    std::string step;
    std::size_t commits = 0;
    std::size_t displacements = 0;
    double trial_m = 0.0;
    double asked_m = 0.0;
    for (const BareServer::Message& message : heard) {
      const bool is_shown = commits == 2;
      if (message.action == 3) trial_m = message.displacement_m;
      if (message.action == 10 && is_shown && trial_m != asked_m) ++displacements;
      if (message.action == 10) asked_m = trial_m;
      if (is_shown) step += (step.empty() ? "" : " ") + std::to_string(message.action);
      if (message.action == 5) ++commits;
    }
    EXPECT_EQ(commits, kSteps) << row.commands;
    EXPECT_EQ(step, row.step) << row.integrator << ": " << row.commands;
    EXPECT_EQ(std::to_string(displacements), row.displacements) << row.integrator << ": " << row.commands;
  }
}

TEST_F(Integrators, OfTheDocsHaveAllThatAreNamed) {
  std::set<std::string> names;
  for (const Row& row : documented_rows()) names.insert(row.integrator);
  EXPECT_THAT(names,
              IsSupersetOf({"AlphaOS", "CentralDifference", "Newmark", "NewmarkHSFixedNumIter", "KRAlphaExplicit"}));
}

/// What the stand-in of the other tests replays is what the real program says.
TEST_F(Integrators, StandInReplaysWhatTheDocsShow) {
  std::set<std::string> steps;
  for (const Row& row : documented_rows()) steps.insert(row.step);
  for (const auto& [name, actions] : generic_client::step_sequences()) {
    std::string step;
    for (const int action : actions) step += (step.empty() ? "" : " ") + std::to_string(action);
    EXPECT_TRUE(steps.contains(step)) << name << ": " << step;
  }
}

TEST_F(Integrators, UdpIsTheSameAsTcp) {
  use("algorithm Linear; integrator AlphaOS 1.0");
  const std::vector<double> reference = unsplit();
  expect_same(split(1, {"-udp"}), reference);
  expect_same(split(2, {"-udp"}), reference);
  // Of 2000 doubles: two datagrams for each message.
  expect_same(split(2, {"-udp", "-dataSize", "2000"}), reference);
}

TEST_F(Integrators, AnySizeOfMessagesIsTheSame) {
  use("algorithm Linear; integrator Newmark 0.5 0.25");
  const std::vector<double> reference = unsplit();
  for (const char* size : {"1", "9", "1024", "50000"}) {
    SCOPED_TRACE(size);
    expect_same(split(2, {"-dataSize", size}), reference);
  }
}

/// The state that Linux gives a process: R runs, S waits, T is stopped.
char run_state(pid_t process) {
  const std::string text = text_of("/proc/" + std::to_string(process) + "/stat");
  const std::size_t name_end = text.rfind(')');
  return name_end == std::string::npos ? '?' : text.at(name_end + 2);
}

class RealClient : public Integrators {
 protected:
  void SetUp() override {
    Integrators::SetUp();
    if (!IsSkipped()) use("algorithm Linear; integrator AlphaOS 1.0");
  }
  /// A running analysis, whose third question for a force waits for its answer.
  StartedProgram asking(ServedSprings& springs) const {
    StartedProgram program = start({"1", std::to_string(springs.port()), "0"});
    EXPECT_TRUE(springs.answer_until(ElementRequest::Kind::force, 2)) << program.standard_error();
    for (;;) {
      const auto request = springs.next();
      EXPECT_TRUE(request.has_value());
      if (!request || request->kind == ElementRequest::Kind::force) return program;
    }
  }
  static std::vector<Eigen::MatrixXd> storey() { return {Eigen::MatrixXd::Constant(1, 1, kFirstStorey)}; }
};

TEST_F(RealClient, StoppedInAStepGoesOnWhereItWas) {
  const std::vector<double> reference = unsplit();
  ServedSprings springs{storey()};
  StartedProgram program = start({"1", std::to_string(springs.port()), "0"});
  ASSERT_TRUE(springs.answer_until(ElementRequest::Kind::force, 3));
  program.signal(SIGSTOP);
  ASSERT_TRUE(wait_until([&] { return run_state(program.process()) == 'T'; }));
  program.signal(SIGCONT);
  EXPECT_TRUE(springs.answer_until(ElementRequest::Kind::die));
  EXPECT_THAT(program.wait(), Optional(0));
  expect_same(floors(), reference);
}

TEST_F(RealClient, WaitsWithoutLoadForAnAnswer) {
  ServedSprings springs{storey()};
  StartedProgram program = asking(springs);
  EXPECT_TRUE(wait_until([&] { return run_state(program.process()) == 'S'; }));
  EXPECT_TRUE(program.is_running());
}

TEST_F(RealClient, NeverEndsByItselfWhenItsServerIsGone) {
  auto springs = std::make_unique<ServedSprings>(storey());
  StartedProgram program = asking(*springs);
  springs.reset();
  EXPECT_TRUE(wait_until([&] { return run_state(program.process()) == 'R'; }));
  EXPECT_TRUE(program.is_running());
  program.signal(SIGTERM);
  EXPECT_THAT(program.wait(), Optional(128 + SIGTERM));
}

TEST_F(RealClient, KilledIsLostWhileItsQuestionIsOpen) {
  ServedSprings springs{storey()};
  StartedProgram program = asking(springs);
  program.signal(SIGKILL);
  const auto request = springs.next();
  ASSERT_TRUE(request.has_value());
  EXPECT_EQ(request->kind, ElementRequest::Kind::lost);
  EXPECT_EQ(request->fault, ClientFault::closed);
}

TEST_F(RealClient, DivergedAnalysisIsLostBeforeItMovesAnything) {
  ServedSprings springs{storey()};
  StartedProgram program = asking(springs);
  springs.server().answer_force(0, Eigen::VectorXd::Constant(1, std::nan("")));
  const auto lost = springs.answer_until(ElementRequest::Kind::lost);
  ASSERT_TRUE(lost.has_value());
  EXPECT_EQ(lost->fault, ClientFault::not_finite);
  for (const Eigen::VectorXd& trial : springs.trials()) EXPECT_TRUE(trial.allFinite());
  EXPECT_TRUE(program.is_running()) << "its connection is kept open";
}

}  // namespace
}  // namespace hybridtest
