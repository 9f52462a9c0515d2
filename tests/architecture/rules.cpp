#include "tests/architecture/rules.hpp"

#include <algorithm>
#include <optional>
#include <regex>
#include <string_view>

namespace hybridtest::architecture {
namespace {

using Paths = std::vector<std::string>;

/// A part of the tree and what of ours it may include besides itself. The part of a file is the one with the longest
/// matching path, so a subfolder with a row of its own is not covered by the row of its folder.
struct Part {
  std::string path;
  Paths may_include;
};

/// The rows of `lower` and, behind them, `more`.
Paths joined(const Paths& lower, const Paths& more) {
  Paths all = lower;
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

const std::vector<Part>& parts() {
  static const Paths models{"core", "mechanics", "compensation", "plant"};
  static const Paths nodes{"coordinator", "numerical_substructure", "experimental_site",
                           "experimental_site/rigs/simulated_rig.hpp"};
  static const Paths participants =
      joined(joined(models, nodes), {"core/config", "transport", "transport/fast_dds", "recording", "scenario"});
  static const Paths product = joined(
      participants, {"runtime", "report/plotting", "report/live", "report/run_report", "report/run_index", "diagnosis",
                     "diagnosis/runs", "validation/blind_batches", "validation/blind_batches/plant",
                     "validation/design_motion", "validation/reference", "validation/studies", "validation/sweep"});
  static const Paths everything = joined(product, {"idl", "launch", "tests", "benchmarks"});
  static const std::vector<Part> table{
      {"idl", {}},
      {"core", {}},
      {"core/config", {"core"}},
      {"mechanics", {"core"}},
      {"compensation", {"core"}},
      {"plant", {"core", "mechanics", "compensation"}},
      {"coordinator", {"core", "mechanics"}},
      {"numerical_substructure", {"core", "mechanics"}},
      {"experimental_site", {"core", "compensation"}},
      // A rig that stands in for a laboratory; the rigs of laboratories do not know the plant.
      {"experimental_site/rigs/simulated_rig.hpp", joined({"experimental_site"}, models)},
      {"experimental_site/rigs/simulated_rig.cpp",
       joined({"experimental_site", "experimental_site/rigs/simulated_rig.hpp"}, models)},
      {"transport", {"core"}},
      {"transport/fast_dds", {"core", "transport", "idl"}},
      {"recording", {"core"}},
      {"scenario", joined(joined(models, nodes), {"core/config", "recording"})},
      {"runtime", participants},
      {"report/plotting", {"core"}},
      {"report/live", joined(participants, {"runtime"})},
      {"report/run_report", joined(participants, {"runtime", "report/plotting"})},
      {"report/run_index", joined(participants, {"runtime", "report/plotting"})},
      {"diagnosis", joined(models, {"coordinator", "report/plotting"})},
      {"diagnosis/runs", joined(models, {"coordinator", "core/config", "report/plotting", "diagnosis", "recording",
                                         "scenario", "runtime"})},
      {"validation/blind_batches", {"core", "validation/blind_batches/plant"}},
      {"validation/blind_batches/plant", {}},
      {"validation/design_motion", {"core", "coordinator"}},
      {"validation/reference", joined(participants, {"runtime"})},
      {"validation/studies", joined(participants, {"runtime", "report/plotting"})},
      {"validation/sweep", joined(participants, {"runtime", "report/plotting", "validation/studies"})},
      {"launch", product},
      // Composition: may include what launch may.
      {"coordinator/main.cpp", product},
      {"numerical_substructure/main.cpp", product},
      {"experimental_site/main.cpp", product},
      {"tests", everything},
      {"benchmarks", everything},
  };
  return table;
}

/// Headers from outside and the only places that may include them.
struct Library {
  std::string name;
  Paths headers;  // beginnings
  Paths used_in;
};

const std::vector<Library>& libraries() {
  static const std::vector<Library> table{
      // The benchmarks measure a bare Fast DDS echo; these tests look at the wire.
      {"DDS",
       {"fastdds/", "fastrtps/", "fastcdr/", "hybridtest.h", "hybridtestPubSubTypes.h", "hybridtestTypeObject.h"},
       {"transport/fast_dds", "idl", "benchmarks", "tests/contract", "tests/fuzz/wire",
        "tests/unit/transport/fast_dds"}},
      {"yaml-cpp", {"yaml-cpp/"}, {"core/config", "tests/unit/scenario"}},
      {"HDF5", {"hdf5.h", "H5", "hdf5/", "hdf5_hl.h"}, {"recording", "tests"}},
      {"nlohmann-json",
       {"nlohmann/"},
       {"recording", "report", "diagnosis", "validation/blind_batches", "validation/sweep", "launch", "tests"}},
      {"cpp-httplib", {"httplib.h"}, {"report/live", "tests", "benchmarks"}},
      {"Ceres", {"ceres/"}, {"diagnosis/identification"}},
      {"Spectra", {"Spectra/"}, {"mechanics"}},
      {"muParser", {"muParser"}, {"scenario/catalogue"}},
      {"spdlog", {"spdlog/"}, {"runtime", "launch"}},
      {"fmt", {"fmt/"}, {"launch", "runtime", "scenario", "report", "diagnosis", "validation", "tests", "benchmarks"}},
      {"CLI11", {"CLI/"}, {"launch", "runtime", "validation/design_motion/main.cpp", "benchmarks"}},
      {"OpenSSL", {"openssl/"}, {"scenario", "transport/fast_dds/credentials.cpp"}},
      {"GoogleTest", {"gtest/", "gmock/"}, {"tests"}},
      {"Eigen",
       {"Eigen/", "unsupported/Eigen/"},
       {"core", "mechanics", "compensation", "plant", "coordinator", "numerical_substructure", "experimental_site",
        "scenario", "runtime", "report", "diagnosis", "validation", "launch", "tests", "benchmarks"}},
  };
  return table;
}

/// Headers of the operating system; any part may include them.
const Paths& system_headers() {
  static const Paths beginnings{"arpa/",    "dlfcn.h",  "execinfo.h", "fcntl.h", "linux/",      "netdb.h",  "net/",
                                "netinet/", "poll.h",   "pthread.h",  "sched.h", "semaphore.h", "signal.h", "spawn.h",
                                "sys/",     "syslog.h", "termios.h",  "time.h",  "unistd.h"};
  return beginnings;
}

/// Words of code that only some places may use.
struct RestrictedWords {
  std::string what;
  std::regex words;
  Paths used_in;
};

const std::vector<RestrictedWords>& restricted_words() {
  static const std::vector<RestrictedWords> table{
      {"names a clock of the machine",
       std::regex{R"(\b(steady_clock|system_clock|high_resolution_clock|utc_clock|file_clock)\b)"
                  R"(|\b(clock_gettime|gettimeofday|timespec_get)\b|\btime\s*\(\s*(nullptr|NULL|0)\s*\))"},
       {"runtime/executor.hpp", "runtime/executor.cpp", "runtime/run_directory.cpp", "recording/recorder_thread.hpp",
        "recording/recorder_thread.cpp", "transport", "tests/contract", "tests/realtime", "tests/system",
        "tests/support/started_program.cpp", "tests/support/emulated_network.hpp", "tests/support/emulated_network.cpp",
        "tests/unit/core/time_test.cpp", "tests/unit/transport/fast_dds/polled_socket_test.cpp",
        "tests/unit/transport/fast_dds/tcp_transport_test.cpp", "benchmarks"}},
      // HandedClock deletes it in core/time.hpp; a socket that is polled for a time looks at the clock, and so
      // do the filter of its packets and the watch of its connections; runtime and launch read the ProcessClock of the
      // executor; a test's bench may call its own time so.
      {"calls now()",
       std::regex{R"(\bnow\s*\(\s*\))"},
       {"core/time.hpp", "transport/fast_dds/polled_socket.cpp", "transport/fast_dds/filtered_transport.cpp",
        "transport/fast_dds/tcp_transport.cpp", "transport/fast_dds/connection_watch.cpp", "runtime", "launch",
        "report/live/connection.cpp", "report/live/watch_server.cpp", "validation/studies/study_progress.cpp", "tests",
        "benchmarks"}},
      {"sleeps",
       std::regex{R"(\b(sleep_for|sleep_until|usleep|nanosleep|clock_nanosleep|sleep\s*\())"},
       {"runtime/executor.cpp", "tests/realtime", "tests/system", "tests/support/started_program.cpp", "benchmarks"}},
      {"waits for a time",
       std::regex{R"(\b(wait_for|wait_until|try_acquire_for|try_lock_for)\b)"},
       {"runtime/executor.cpp", "recording/recorder_thread.cpp", "transport", "tests/contract", "tests/realtime",
        "tests/system", "tests/support/started_program.hpp", "tests/support/started_program.cpp",
        "tests/support/system_fixture.cpp", "tests/unit/transport/fast_dds", "benchmarks"}},
      {"draws from a generator that is not core/random.hpp",
       std::regex{R"(\b(random_device|mt19937|mt19937_64|minstd_rand|default_random_engine|\w+_distribution)\b)"
                  R"(|\bs?rand\s*\()"},
       {"runtime/incarnation.cpp", "validation/blind_batches/plant/plant.hpp"}},
  };
  return table;
}

bool is_below(std::string_view path, std::string_view folder) {
  return path == folder || (path.starts_with(folder) && path.size() > folder.size() && path[folder.size()] == '/');
}

bool is_below_any(std::string_view path, const Paths& folders) {
  return std::ranges::any_of(folders, [&](const std::string& folder) { return is_below(path, folder); });
}

const Part* part_of(std::string_view path) {
  const Part* longest = nullptr;
  for (const Part& part : parts()) {
    if (is_below(path, part.path) && (longest == nullptr || part.path.size() > longest->path.size())) longest = &part;
  }
  return longest;
}

const Library* library_of(std::string_view header) {
  for (const Library& library : libraries()) {
    if (std::ranges::any_of(library.headers, [&](const auto& begin) { return header.starts_with(begin); })) {
      return &library;
    }
  }
  return nullptr;
}

std::optional<std::string> wrong_include(const SourceFile& file, const Part& part, const std::string& header) {
  if (const Part* included = part_of(header)) {
    const bool may =
        included->path == part.path || std::ranges::find(part.may_include, included->path) != part.may_include.end();
    if (may) return {};
    return "no arrow from " + part.path + " to it";
  }
  if (const Library* library = library_of(header)) {
    if (is_below_any(file.path, library->used_in)) return {};
    return "a header of " + library->name + ", which has no business here";
  }
  if (header.starts_with('.')) return "includes are written from the root of the repository";
  const bool is_standard = header.find_first_of("./") == std::string::npos;
  const bool is_of_system =
      std::ranges::any_of(system_headers(), [&](const auto& begin) { return header.starts_with(begin); });
  if (!is_standard && !is_of_system) return "a header of a library that the table of libraries does not have";
  return {};
}

int line_of(std::string_view text, std::ptrdiff_t position) {
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + position, '\n'));
}

}  // namespace

std::vector<std::string> violations(const std::vector<SourceFile>& files) {
  std::vector<std::string> found;
  for (const SourceFile& file : files) {
    const Part* part = part_of(file.path);
    if (part == nullptr) {
      found.push_back(file.path + ": a folder that the table of parts does not have");
      continue;
    }
    for (const std::string& header : included_by(file.text)) {
      if (const auto wrong = wrong_include(file, *part, header)) {
        found.push_back(file.path + " includes " + header + ": " + *wrong);
      }
    }
    const std::string code = code_alone(file.text);
    for (const RestrictedWords& restricted : restricted_words()) {
      std::smatch match;
      if (is_below_any(file.path, restricted.used_in) || !std::regex_search(code, match, restricted.words)) continue;
      found.push_back(file.path + ":" + std::to_string(line_of(code, match.position())) + " " + restricted.what + ": " +
                      match.str());
    }
  }
  return found;
}

}  // namespace hybridtest::architecture
