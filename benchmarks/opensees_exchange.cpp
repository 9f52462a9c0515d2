// One step of an OpenSees that leads, over loopback: our server of its element, answered by a thread that waits as the
// coordinator does, over a bare blocking socket. AlphaOS with one element of one degree of freedom: 3 13 14 10 14 3 5.
//
// First with a client of our own, then, where there is an OpenSees, with the real one, whose time is that of its
// analysis. The two servers take turns. A bare socket that does not acknowledge at once shows what that costs.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "benchmarks/latency_report.hpp"
#include "coordinator/opensees/generic_client_server.hpp"
#include "core/child_process.hpp"
#include "core/config_error.hpp"
#include "core/opensees_program.hpp"
#include "tests/contract/opensees/bare_server.hpp"
#include "tests/support/stand_in_client.hpp"
#include "transport/waker.hpp"

namespace {

using namespace hybridtest;
using Clock = std::chrono::steady_clock;
using Times = std::vector<double>;

constexpr double kStiffness_n_per_m = 4.0e6;
constexpr int kTurns = 10;
constexpr int kWarmUp = 50;
constexpr int kSteps = 450;
constexpr int kSlowSteps = 60;  // of 40 ms and more

/// Runs a client against the port. @return the time of each of its steps [us].
using Client = std::function<Times(std::uint16_t port, int steps)>;

Times steps_of_stand_in(std::uint16_t port, int steps) {
  StandInClient client{port, StandInClient::Over::tcp};
  client.send(generic_client::sizes(1));
  Times times_us;
  for (int step = 0; step < steps; ++step) {
    const Clock::time_point start = Clock::now();
    for (const int action : {3, 13, 14, 10, 14, 3, 5}) {
      client.send(action == 3 ? generic_client::trial(1, 1e-6 * step) : generic_client::message(action));
      if (action >= 10 && !client.answer()) throw std::runtime_error{"no answer came"};
    }
    times_us.push_back(std::chrono::duration<double, std::micro>{Clock::now() - start}.count());
  }
  client.send(generic_client::message(99.0));
  return times_us;
}

constexpr const char* kModel = R"(
model BasicBuilder -ndm 1 -ndf 1
node 1 0.0 -mass 20.0e3
element genericClient 1 -node 1 -dof 1 -server [lindex $argv 0] 127.0.0.1
timeSeries Trig 1 0.0 1000.0 0.5
pattern UniformExcitation 1 1 -accel 1
constraints Plain
numberer Plain
system FullGeneral
algorithm Linear
integrator AlphaOS 1.0
analysis Transient
set file [open times.txt w]
for {set step 0} {$step < [lindex $argv 1]} {incr step} {
  set start [clock microseconds]
  if {[analyze 1 0.001] != 0} { exit 1 }
  puts $file [expr {[clock microseconds] - $start}]
}
close $file
wipe
)";

/// The real one, in a folder of this process.
class OpenSeesClient {
 public:
  OpenSeesClient()
      : program_{find_opensees("")},
        directory_{std::filesystem::temp_directory_path() / ("opensees_exchange_" + std::to_string(::getpid()))} {
    std::filesystem::create_directories(directory_);
    std::ofstream{directory_ / "model.tcl"} << kModel;
  }
  ~OpenSeesClient() {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }
  OpenSeesClient(const OpenSeesClient&) = delete;
  OpenSeesClient& operator=(const OpenSeesClient&) = delete;

  [[nodiscard]] const std::filesystem::path& program() const noexcept { return program_; }
  [[nodiscard]] Times operator()(std::uint16_t port, int steps) const {
    ChildProcess child{"opensees",
                       {.program = program_,
                        .arguments = {"model.tcl", std::to_string(port), std::to_string(steps)},
                        .log_file = directory_ / "opensees.log",
                        .directory = directory_,
                        .is_killed_with_parent = true}};
    if (!child.wait_for_end(std::chrono::seconds{60})) child.kill();
    Times times_us;
    std::ifstream file{directory_ / "times.txt"};
    for (double time_us = 0.0; file >> time_us;) times_us.push_back(time_us);
    if (times_us.size() != static_cast<std::size_t>(steps)) {
      throw std::runtime_error{"OpenSees did not complete its analysis: " + child.last_words()};
    }
    return times_us;
  }

 private:
  std::filesystem::path program_;
  std::filesystem::path directory_;
};

Times over_bare_socket(const Client& client, int steps, bool acknowledges_at_once) {
  BareServer server{kStiffness_n_per_m, acknowledges_at_once};
  return client(server.port(), steps);
}

Times over_our_server(const Client& client, int steps) {
  std::vector<ServedElement> elements(1);
  elements[0].matrices = {Eigen::MatrixXd::Constant(1, 1, kStiffness_n_per_m), Eigen::MatrixXd::Zero(1, 1),
                          Eigen::MatrixXd::Zero(1, 1)};
  Waker waker;
  GenericClientServer server{"127.0.0.1", "127.0.0.1", std::move(elements), [&] { waker.signal(); }};
  std::thread coordinator{[&] {
    ElementRequest request;
    Eigen::VectorXd force_n = Eigen::VectorXd::Zero(1);
    for (;;) {
      static_cast<void>(waker.wait_until(Clock::time_point::max()));
      while (server.take(request)) {
        if (request.kind == ElementRequest::Kind::trial) force_n[0] = kStiffness_n_per_m * request.displacement_m[0];
        if (request.kind == ElementRequest::Kind::force) server.answer_force(0, force_n);
        if (request.kind == ElementRequest::Kind::die || request.kind == ElementRequest::Kind::lost) return;
      }
    }
  }};
  Times times_us;
  try {
    times_us = client(server.port(0), steps);
  } catch (...) {
    std::fputs("the client failed while our server served it\n", stderr);
    std::abort();  // the thread still waits
  }
  coordinator.join();
  return times_us;
}

void compare(const std::string& name, const Client& client) {
  Times bare_us;
  Times ours_us;
  const auto keep = [](Times& all, const Times& turn) { all.insert(all.end(), turn.begin() + kWarmUp, turn.end()); };
  for (int turn = 0; turn < kTurns; ++turn) {
    keep(bare_us, over_bare_socket(client, kWarmUp + kSteps, true));
    keep(ours_us, over_our_server(client, kWarmUp + kSteps));
  }
  Times slow_us = over_bare_socket(client, kSlowSteps, false);
  slow_us.erase(slow_us.begin(), slow_us.begin() + kSlowSteps / 2);  // it begins with immediate acknowledgements
  using benchmarks::latency_json;
  using benchmarks::percentile_us;
  std::puts(latency_json(name + ", bare socket", bare_us).c_str());
  std::puts(latency_json(name + ", our server", ours_us).c_str());
  std::puts(latency_json(name + ", bare socket without quick acknowledgement", slow_us).c_str());
  std::printf("%s: our server takes %.1f us more than the bare socket (median; 99th percentile %.1f us), ratio %.2f\n",
              name.c_str(), percentile_us(ours_us, 0.5) - percentile_us(bare_us, 0.5),
              percentile_us(ours_us, 0.99) - percentile_us(bare_us, 0.99),
              percentile_us(ours_us, 0.5) / percentile_us(bare_us, 0.5));
}

}  // namespace

int main() {
  try {
    compare("client of our own", steps_of_stand_in);
    try {
      const OpenSeesClient opensees;
      compare("OpenSees", std::cref(opensees));
    } catch (const ConfigError& error) {
      std::printf("OpenSees is left out: %s\n", error.what());
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
