#include "tests/architecture/rules.hpp"

#include <algorithm>
#include <optional>
#include <regex>
#include <string_view>

namespace hybridtest::architecture {
namespace {

using Paths = std::vector<std::string>;

/// A part of the tree and what of ours it may include besides itself. The longest matching path
/// counts.
struct Part {
  std::string path;
  Paths may_include;
};

const Paths& every_part() {
  static const Paths paths{"core",      "mechanics",  "compensation", "coordinator", "numerical_substructure",
                           "transport", "recording",  "launch",       "diagnosis",   "experimental_site",
                           "tests",     "benchmarks", "idl"};
  return paths;
}

const Paths& what_launch_may_include() {
  static const Paths paths{"core",      "mechanics", "compensation", "coordinator", "numerical_substructure",
                           "transport", "recording", "launch",       "diagnosis",   "experimental_site"};
  return paths;
}

const std::vector<Part>& parts() {
  static const std::vector<Part> table{
      {"idl", {}},
      {"core", {}},
      {"mechanics", {"core"}},
      {"compensation", {"core"}},
      {"coordinator", {"core"}},
      {"numerical_substructure", {"core", "mechanics"}},
      {"experimental_site", {"core", "mechanics", "compensation"}},
      {"diagnosis",
       {"core", "mechanics", "compensation", "coordinator", "experimental_site/rigs", "experimental_site/effects",
        "experimental_site/transfer_systems", "experimental_site/sensors"}},
      {"transport", {"core"}},
      {"recording", {"core"}},
      {"launch", what_launch_may_include()},
      // Composition: may include what launch may.
      {"coordinator/main.cpp", what_launch_may_include()},
      {"numerical_substructure/main.cpp", what_launch_may_include()},
      {"experimental_site/main.cpp", what_launch_may_include()},
      {"tests", every_part()},
      {"benchmarks", every_part()},
  };
  return table;
}

/// Headers from outside and the only places that may know of them.
struct Library {
  std::string name;
  Paths headers;  // beginnings
  Paths used_in;
};

const std::vector<Library>& libraries() {
  static const std::vector<Library> table{
      // The benchmarks measure a bare Fast DDS echo; these tests look at the wire.
      {"DDS",
       {"fastdds/", "fastrtps/", "fastcdr/", "hybridtest.h", "hybridtestPubSubTypes.h"},
       {"transport/fast_dds", "idl", "benchmarks", "tests/contract", "tests/fuzz", "tests/unit/transport"}},
      {"yaml-cpp", {"yaml-cpp/"}, {"core/config", "tests/unit/launch"}},
      {"HDF5", {"hdf5.h", "H5", "hdf5/", "hdf5_hl.h"}, {"recording", "tests"}},
      {"nlohmann-json", {"nlohmann/"}, {"recording", "diagnosis", "tests"}},
      {"spdlog", {"spdlog/"}, {"launch"}},
      {"fmt", {"fmt/"}, {"launch", "diagnosis", "tests", "benchmarks"}},
      {"CLI11", {"CLI/"}, {"launch", "benchmarks"}},
      {"OpenSSL", {"openssl/"}, {"launch"}},
      {"GoogleTest", {"gtest/", "gmock/"}, {"tests"}},
  };
  return table;
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
       {"launch/executor.hpp", "launch/executor.cpp", "launch/run_directory.cpp", "recording/recorder_thread.hpp",
        "recording/recorder_thread.cpp", "transport", "tests/contract", "tests/realtime", "tests/system",
        "tests/support/started_program.cpp", "tests/unit/core/time_test.cpp", "benchmarks"}},
      // HandedClock deletes it in core/time.hpp; launch reads the ProcessClock of its executor; a
      // test's bench may call its own time so.
      {"calls now()", std::regex{R"(\bnow\s*\(\s*\))"}, {"core/time.hpp", "launch", "tests", "benchmarks"}},
      {"sleeps",
       std::regex{R"(\b(sleep_for|sleep_until|usleep|nanosleep|clock_nanosleep|sleep\s*\())"},
       {"launch/executor.cpp", "tests/realtime", "tests/system", "tests/support/started_program.cpp", "benchmarks"}},
      {"waits for a time",
       std::regex{R"(\b(wait_for|wait_until|try_acquire_for|try_lock_for)\b)"},
       {"launch/executor.cpp", "recording/recorder_thread.cpp", "transport", "tests/contract", "tests/realtime",
        "tests/system", "tests/support/started_program.hpp", "tests/support/started_program.cpp",
        "tests/support/system_test.cpp", "benchmarks"}},
      {"draws from a generator that is not core/random.hpp",
       std::regex{R"(\b(random_device|mt19937|mt19937_64|minstd_rand|default_random_engine|\w+_distribution)\b)"
                  R"(|\bs?rand\s*\()"},
       {"launch/incarnation.cpp", "diagnosis/blind/blind_plant/random_stream.hpp"}},
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

/// The folder of ours that a part belongs to: `coordinator` for `coordinator/main.cpp`.
std::string_view folder_of(std::string_view path) { return path.substr(0, path.find('/')); }

std::optional<std::string> wrong_include(const SourceFile& file, const Part& part, const std::string& header) {
  if (part_of(header) != nullptr) {
    if (is_below(header, folder_of(file.path)) || is_below_any(header, part.may_include)) return {};
    return "no arrow from " + part.path + " to it";
  }
  if (const Library* library = library_of(header)) {
    if (is_below_any(file.path, library->used_in)) return {};
    return "a header of " + library->name + ", which has no business here";
  }
  if (header.starts_with('.')) return "includes are written from the root of the repository";
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
