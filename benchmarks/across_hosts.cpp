// Tests across hosts over an emulated network: steps completed, difference from lockstep without a network, forces that
// were bridged, commands that were sent again, and the wall time of a step, median and longest, over one emulated round
// trip and, where the site imposes a step after it heard of it, its time. Needs root and /dev/net/tun; takes minutes.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/programs_on_hosts.hpp"

namespace hybridtest {
namespace {

using std::chrono::milliseconds;
using Arguments = std::vector<std::string>;

const std::filesystem::path kPrograms{HYBRIDTEST_PROGRAM_DIR};
const std::filesystem::path kScenario =
    std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch" / "scenarios" / "two_storey_one_site.yaml";
constexpr double kStep_s = 0.02;
constexpr int kSteps = 100;
constexpr const char* kFloor = "displacement_floor_1_m";

struct Network {
  std::string name;
  LinkConditions conditions;
  int cut_ms = 0;  // after a third of the test
};

struct Mode {
  std::string name;
  bool imposes = false;        // the site takes a step's time to impose it after it heard of it
  bool has_deadlines = false;  // a step takes its time, whatever the network does
  Arguments arguments;
};

Arguments settings(const std::vector<std::string>& values) {
  Arguments arguments;
  for (const std::string& value : values) arguments.insert(arguments.end(), {"--set", value});
  return arguments;
}

LinkConditions round_trip(int milliseconds_there_and_back) {
  LinkConditions conditions;
  conditions.delay = std::chrono::microseconds{500 * milliseconds_there_and_back};
  return conditions;
}

/// In real time a round trip has to fit into a step.
std::vector<Network> networks(bool has_deadlines) {
  const int base = has_deadlines ? 10 : 50;
  const std::string name = fmt::format("{} ms", base);
  std::vector<Network> all;
  for (const int ms : {10, 50, 150}) {
    if (!has_deadlines || ms == base) all.push_back({fmt::format("{} ms", ms), round_trip(ms)});
  }
  for (const int percent : {1, 5, 20}) {
    Network one{fmt::format("{}, {} % lost", name, percent), round_trip(base)};
    one.conditions.loss = 0.01 * percent;
    all.push_back(one);
  }
  Network bursts{name + ", bursts of 10", round_trip(base)};
  bursts.conditions.bursts = {.to_bad = 0.005, .to_good = 0.1};
  all.push_back(bursts);
  Network doubled{name + ", 10 % twice, 10 % late", round_trip(base)};
  doubled.conditions.duplication = 0.1;
  doubled.conditions.reordering = 0.1;
  doubled.conditions.reordered_by = milliseconds{base / 2};
  all.push_back(doubled);
  Network jitter{fmt::format("{} + 0 to {} ms each way", name, 2 * base / 5), round_trip(base)};
  jitter.conditions.jitter = milliseconds{2 * base / 5};
  all.push_back(jitter);
  all.push_back({name + ", cut for 1 s", round_trip(base), 1000});
  if (!has_deadlines) all.push_back({name + ", cut for 10 s", round_trip(base), 10'000});
  return all;
}

std::vector<Mode> modes() {
  const std::string ideal =
      "substructures[storey_1].rig={type: simulated, transfer_system: {type: ideal}, specimen: {type: bilinear, "
      "stiffness_n_per_m: 4.0e6, yield_force_n: 40.0e3, hardening_ratio: 0.05}}";
  const std::string plain = "substructures[storey_1].compensator={type: none}";
  const auto real_time = [](const std::string& bridge) {
    return settings({"time.mode=real_time", "bridging={start_anyway: true, most_in_a_row: 20, " + bridge + "}"});
  };
  return {
      {"lockstep", false, false, settings({"time.mode=lockstep"})},
      {"paced, ramp and hold, ideal rig", true, false,
       settings({"time.mode=paced", "substructures[storey_1].trajectory={type: ramp_and_hold}", ideal, plain})},
      {"paced, continuous", true, false, settings({"time.mode=paced"})},
      {"real time, held forces", false, true, real_time("type: hold")},
      {"real time, line", false, true, real_time("type: polynomial, order: 1")},
  };
}

double mean(const std::vector<double>& values) {
  return std::reduce(values.begin(), values.end()) / static_cast<double>(values.size());
}

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

/// The displacement of a floor of a test that has no network, in lockstep under simulated time.
std::vector<double> lockstep_m(const Arguments& arguments, const std::filesystem::path& directory) {
  Arguments all{"simulate", kScenario.string(), "--seed", "1", "--out", (directory / "lockstep").string()};
  for (std::size_t i = 0; i + 1 < arguments.size(); i += 2) {
    const bool is_of_the_mode = arguments[i + 1].starts_with("time.mode") || arguments[i + 1].starts_with("bridging");
    if (!is_of_the_mode) all.insert(all.end(), {arguments[i], arguments[i + 1]});
  }
  StartedProgram simulated{kPrograms / "hybridtest", all, directory / "lockstep.output"};
  if (simulated.wait() != 0) throw std::runtime_error{simulated.standard_error()};
  return RecordedRun{directory / "lockstep"}.column("coordinator", "steps", kFloor);
}

std::string difference(const std::vector<double>& measured_m, const std::vector<double>& expected_m) {
  if (measured_m == expected_m) return "the same bits";
  double largest_m = 0.0;
  double peak_m = 0.0;
  for (std::size_t i = 0; i < std::min(measured_m.size(), expected_m.size()); ++i) {
    largest_m = std::max(largest_m, std::abs(measured_m[i] - expected_m[i]));
    peak_m = std::max(peak_m, std::abs(expected_m[i]));
  }
  return fmt::format("{:.2g} %", 100.0 * largest_m / peak_m);
}

void cut_in_the_middle(EmulatedNetwork& network, const RecordedRun& record, double steps, int cut_ms) {
  if (!wait_until([&] { return record.last_step("coordinator") >= steps / 3.0; })) return;
  network.cut(1, true);
  ::usleep(1000 * static_cast<unsigned>(cut_ms));
  network.cut(1, false);
}

void run(const Mode& mode, const Network& network, const std::filesystem::path& directory, bool prints_messages) {
  const double round_trip_s = 2.0 * to_seconds(network.conditions.delay + network.conditions.jitter / 2);
  std::vector<EmulatedHost> hosts;
  for (int number = 1; number <= 3; ++number) hosts.emplace_back(number);
  EmulatedNetwork emulated{std::move(hosts), 1, false};
  emulated.set_all(network.conditions);
  Arguments arguments = mode.arguments;
  Arguments more = settings({fmt::format("time.step_s={}", kStep_s),
                             fmt::format("time.duration_s={}", kSteps * kStep_s), "excitation.scale=3.0"});
  if (!mode.has_deadlines) {
    const Arguments waits = settings({"timeouts={link_s: 30}"});
    more.insert(more.end(), waits.begin(), waits.end());
  }
  arguments.insert(arguments.end(), more.begin(), more.end());
  ProgramsOnHosts programs{emulated,
                           {{kPrograms / "coordinator", "coordinator"},
                            {kPrograms / "experimental_site", "storey_1"},
                            {kPrograms / "numerical_substructure", "storey_2"}},
                           kScenario,
                           directory,
                           arguments};
  const RecordedRun record{directory / "coordinator"};
  if (network.cut_ms > 0) cut_in_the_middle(emulated, record, kSteps, network.cut_ms);
  const std::vector<int> exit_codes = programs.wait(std::chrono::minutes{3});
  if (prints_messages) fmt::print("{}\n", programs.messages());

  const std::vector<double> step = record.column("coordinator", "steps", "step");
  const std::vector<double> wall_s = record.column("coordinator", "steps", "wall_time_s");
  const std::vector<double> attempts = record.column("coordinator", "exchanges", "attempts");
  const std::vector<double> flags = record.column("coordinator", "exchanges", "flags");
  std::vector<double> each_s;
  for (std::size_t i = 2; i < wall_s.size(); ++i) each_s.push_back(wall_s[i] - wall_s[i - 1]);
  bool is_in_order = true;
  for (std::size_t i = 0; i < step.size(); ++i) is_in_order = is_in_order && step[i] == static_cast<double>(i);
  const double expected_s = mode.has_deadlines ? kStep_s : round_trip_s + (mode.imposes ? kStep_s : 0.0);
  const auto bridged = std::ranges::count_if(flags, [](double value) {
    return any(static_cast<MeasurementFlags>(static_cast<std::uint32_t>(value)) & MeasurementFlags::bridged);
  });
  const LinkCounters counters = emulated.counters();
  fmt::print("| {} | {} | {} {} {} | {} of {}{} | {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.1f} | {:.1f} | {:.1f} |\n",
             mode.name, network.name, exit_codes[0], exit_codes[1], exit_codes[2], step.size(), kSteps + 1,
             is_in_order ? "" : " NOT IN ORDER",
             difference(record.column("coordinator", "steps", kFloor), lockstep_m(arguments, directory)), bridged,
             mean(attempts), mean(each_s) / expected_s, median(each_s) / expected_s,
             *std::ranges::max_element(each_s) / expected_s,
             100.0 * static_cast<double>(counters.lost + counters.cut) / static_cast<double>(counters.taken),
             record.events("coordinator", EventCode::test_started).front().clock / std::chrono::duration<double>{1.0});
  std::fflush(stdout);
}

int measure(int argc, char** argv) {
  if (const std::string why = EmulatedHost::why_not(); !why.empty()) {
    fmt::print("{}\n", why);
    return 0;
  }
  // across_hosts [MODE [NETWORK [messages]]]: those whose names contain these.
  const std::string of_mode = argc > 1 ? argv[1] : "";
  const std::string of_network = argc > 2 ? argv[2] : "";
  std::string pattern = (std::filesystem::temp_directory_path() / "across_hosts_XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error{"no temporary directory"};
  fmt::print(
      "| mode | network | exit codes | steps | from lockstep | bridged | commands a step | mean | median | "
      "longest | lost % | started s |\n");
  fmt::print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  int number = 0;
  for (const Mode& mode : modes()) {
    for (const Network& network : networks(mode.has_deadlines)) {
      if (mode.name.find(of_mode) == std::string::npos || network.name.find(of_network) == std::string::npos) continue;
      const std::filesystem::path directory = std::filesystem::path{pattern} / std::to_string(number++);
      std::filesystem::create_directories(directory);
      run(mode, network, directory, argc > 3);
    }
  }
  std::filesystem::remove_all(pattern);
  return 0;
}

}  // namespace
}  // namespace hybridtest

int main(int argc, char** argv) {
  try {
    return hybridtest::measure(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
