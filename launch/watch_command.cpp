#include <fmt/format.h>
#include <unistd.h>

#include "core/config_error.hpp"
#include "core/exit_code.hpp"
#include "launch/commands.hpp"
#include "report/live/observer.hpp"
#include "report/live/watch_server.hpp"
#include "runtime/executor.hpp"
#include "runtime/incarnation.hpp"
#include "runtime/network_options.hpp"
#include "runtime/run_directory.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {
namespace {

/// After the end of the test and the last question of a page.
constexpr Duration kStay = std::chrono::seconds{60};

struct WatchOptions {
  std::string test_name;
  std::filesystem::path scenario_file;
  bool allow_control = false;
  bool end_with_test = false;
  int address_to = -1;  // file descriptor
  WatchServerSettings server;
  NetworkOptions network;
};

std::optional<std::string> chosen_test(const WatchOptions& options) {
  if (!options.test_name.empty()) return options.test_name;
  if (!options.scenario_file.empty()) return read_scenario(options.scenario_file, {}).name;
  return std::nullopt;
}

void tell_address(const WatchOptions& options, const WatchServer& server) {
  if (options.address_to >= 0) {
    const std::string line = server.url() + "\n";
    if (write(options.address_to, line.data(), line.size()) != static_cast<ssize_t>(line.size())) {
      throw std::runtime_error{"cannot tell the address of the page"};
    }
    close(options.address_to);
    return;
  }
  fmt::print("{}\n", server.url());
  std::fflush(stdout);
  fmt::print(stderr, "open this address in a browser; Ctrl-C ends the page and not the test\n");
}

int watch(WatchOptions options) {
  catch_stop_signals();
  const std::optional<std::string> test = chosen_test(options);
  if (options.allow_control) options.server.token = draw_token();
  const ProcessClock clock;
  // Odd, in the range of whole numbers of JavaScript.
  const std::uint64_t first_cursor = draw_incarnation() & 0xff'ffff'ffffU;
  Observer observer{options.network, test, first_cursor, options.allow_control, time_utc};
  wake_on_stop(observer.waker());
  {
    const WatchServer server{observer, clock, options.server};
    tell_address(options, server);
    Instant went_on{};  // a test, at last
    const auto is_done = [&] {
      if (stop_was_requested()) return true;
      if (!options.end_with_test) return false;
      const Instant now = clock.now();
      if (!observer.is_over(now)) went_on = now;
      return now - std::max(went_on, server.last_asked()) > kStay;
    };
    run_until(observer, observer.waker(), clock, is_done, [](Instant) {});
  }
  return kExitCompleted;
}

}  // namespace

void add_watch_command(CLI::App& app, CommandAction& action) {
  auto options = std::make_shared<WatchOptions>();
  CLI::App* command = app.add_subcommand("watch", "Show running tests in the browser, without disturbing them");
  auto* name = command->add_option("NAME", options->test_name, "Name of the test; without it, all that can be heard");
  command->add_option("--scenario", options->scenario_file, "Scenario file (YAML) that holds the name of the test")
      ->excludes(name);
  command->add_option("--port", options->server.port, "Port to listen on; without it, the first free one from 8470")
      ->check(CLI::Range(1, 65535));
  command
      ->add_option("--address", options->server.address,
                   "Address of this machine to listen on; 0.0.0.0: all. Whoever reaches it sees the test")
      ->check(CLI::ValidIPV4)
      ->capture_default_str();
  command->add_flag("--allow-control", options->allow_control,
                    "Let whoever has the printed address pause, resume and stop tests");
  command->add_option("--out", options->server.run_directory, "Run directory whose report the page links");
  // Of `run --watch`.
  command->add_flag("--end-with-test", options->end_with_test)->group("");
  command->add_option("--address-to", options->address_to)->group("");
  options->network.add_to(*command);
  command->callback([options, &action] { action = [options] { return watch(*options); }; });
}

}  // namespace hybridtest
