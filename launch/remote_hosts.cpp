#include "launch/remote_hosts.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <set>
#include <stdexcept>
#include <utility>

#include "core/config/section.hpp"
#include "core/config_error.hpp"
#include "recording/summary/process_end.hpp"
#include "runtime/run_directory.hpp"
#include "runtime/version.hpp"

namespace hybridtest {
namespace {

constexpr const char* kHostsSchema = "hybridtest-hosts/1";
constexpr int kNotExecutable = 126;
constexpr int kNotFound = 127;
constexpr Duration kCommandLimit = std::chrono::seconds{60};
constexpr Duration kCopyLimit = std::chrono::minutes{10};
constexpr std::size_t kAnswerLines = 40;
/// For a participant to bring its rig to rest, besides the time of the scenario.
constexpr int kStopMargin_s = 10;

/// One word for a shell.
std::string quoted(const std::string& text) {
  std::string word = "'";
  for (const char letter : text) {
    if (letter == '\'') {
      word += "'\\''";
    } else {
      word += letter;
    }
  }
  return word + "'";
}

/// What ssh and a program said, without the frames that ssh draws.
std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) {
    if (line.starts_with("@@")) continue;
    text += (text.empty() ? "" : "; ") + line;
  }
  return text.empty() ? "it said nothing" : text;
}

/// What to do about a connection that ssh did not make, by its words.
std::string ssh_advice(const std::string& said, const std::string& destination) {
  const auto has = [&said](std::string_view words) { return said.find(words) != std::string::npos; };
  const std::string by_hand = fmt::format("`ssh {}`", destination);
  if (has("HOST IDENTIFICATION HAS CHANGED")) {
    return "its key is not the one of known_hosts: another host answers, or it was set up anew; ask its operators "
           "before you remove the old key with `ssh-keygen -R`";
  }
  if (has("Host key verification failed")) {
    return fmt::format(
        "its key is not in known_hosts: run {} once by hand, and compare the fingerprint with its "
        "operators by telephone",
        by_hand);
  }
  if (has("Permission denied")) {
    return fmt::format("it does not accept your key: `ssh-copy-id {}`, or load the key with `ssh-add`", destination);
  }
  if (has("Could not resolve hostname")) return "correct the name in the host file, or in ~/.ssh/config";
  if (has("Connection refused")) return "start the ssh service there, or correct the port in ~/.ssh/config";
  if (has("timed out") || has("No route to host") || has("unreachable")) {
    return "check address, cable and VPN, and that the firewall there lets ssh in";
  }
  return fmt::format("check {} by hand", by_hand);
}

/// Never asks; notices within about 15 s that the other end is gone.
const std::vector<std::string> kSshOptions{"-o", "BatchMode=yes",         "-o", "ConnectTimeout=10",
                                           "-o", "ServerAliveInterval=5", "-o", "ServerAliveCountMax=3"};

/// The scenario and the files that it names, as they lie in the run directory.
std::vector<std::string> files_of(const Scenario& scenario, const RemoteHost& host) {
  std::vector<std::string> files{"scenario.yaml"};
  for (const NamedFile& named : scenario.files) {
    const std::filesystem::path written = std::filesystem::path{named.written}.lexically_normal();
    if (written.is_absolute() || written.string().starts_with("..")) {
      throw ConfigError{
          fmt::format("{}: the scenario names the file {}, which cannot be copied to {} under that name; "
                      "put it beside the scenario or below, and name it from there",
                      host.id, named.written, host.destination)};
    }
    if (std::ranges::find(files, written.string()) == files.end()) files.push_back(written.string());
  }
  return files;
}

ChildStart shell(const std::string& command, const std::filesystem::path& log_file) {
  ChildStart start;
  start.program = "/bin/sh";
  start.arguments = {"-c", command};
  start.log_file = log_file;
  return start;
}

std::string words_of(const std::vector<std::string>& arguments) {
  std::string words;
  for (const std::string& argument : arguments) words += " " + quoted(argument);
  return words;
}

}  // namespace

struct RemoteParticipant::Pipe {
  Pipe() {
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error{"no pipe for ssh"};
  }
  ~Pipe() {
    for (const int end : ends) close(end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  std::array<int, 2> ends{-1, -1};
};

std::vector<RemoteHost> read_remote_hosts(const std::filesystem::path& file, const Scenario& scenario) {
  config::Document document = config::Document::load(file);
  config::Section root = document.root();
  static_cast<void>(root.choice("schema", {kHostsSchema}));
  config::Section hosts = root.section("hosts");
  std::vector<RemoteHost> read;
  for (const std::string& id : hosts.keys()) {
    config::Section section = hosts.section(id);
    RemoteHost host;
    host.id = id;
    const SubstructureScenario* substructure = scenario.find(id);
    if (substructure == nullptr) {
      std::string known;
      for (const auto& other : scenario.substructures) known += (known.empty() ? "" : ", ") + other.id;
      hosts.error(id, "the scenario has no substructure of this id; it has " + known +
                          (id == kCoordinatorId ? "; the coordinator runs where `hybridtest run` does" : ""));
    } else {
      host.role = substructure->role;
    }
    host.destination = section.text("ssh");
    if (host.destination.starts_with('-'))
      section.error("ssh", "expected user@host or a name of the ssh configuration");
    host.folder = section.text("folder", "hybridtest_runs");
    host.programs = section.text("programs", "");
    if (section.has_optional("arguments")) host.arguments = section.names("arguments");
    section.finish();
    read.push_back(std::move(host));
  }
  hosts.finish();
  root.finish();
  document.throw_if_errors();
  return read;
}

RemoteParticipant::RemoteParticipant(RemoteHost host, std::string run_name, std::filesystem::path run_directory)
    : host_{std::move(host)},
      run_name_{std::move(run_name)},
      run_directory_{std::move(run_directory)},
      input_{std::make_shared<Pipe>()} {}

std::string RemoteParticipant::program() const {
  const std::string file{name(host_.role)};
  return host_.programs.empty() ? file : host_.programs + "/" + file;
}

void RemoteParticipant::refuse(const std::string& what) const {
  throw ConfigError{fmt::format("{} on {}: {}", host_.id, host_.destination, what)};
}

RemoteParticipant::Answer RemoteParticipant::run(const ChildStart& start) const {
  ChildProcess process{host_.id, start};
  const bool copies = start.arguments.back().starts_with("exec scp");
  if (!process.wait_for_end(copies ? kCopyLimit : kCommandLimit)) {
    process.kill();
    refuse(fmt::format("no answer within {:.0f} s; see {}", to_seconds(copies ? kCopyLimit : kCommandLimit),
                       start.log_file.string()));
  }
  return {.exit_code = *process.exit_code(), .lines = process.last_lines(kAnswerLines)};
}

RemoteParticipant::Answer RemoteParticipant::ssh(const std::string& script) const {
  std::vector<std::string> words = kSshOptions;
  words.insert(words.end(), {host_.destination, "sh -c " + quoted(script)});
  return run(shell("exec ssh" + words_of(words), log_file()));
}

RemoteParticipant::Answer RemoteParticipant::scp(const std::vector<std::string>& arguments) const {
  std::vector<std::string> words{"-q", "-B", "-r", "-o", "ConnectTimeout=10"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return run(shell("exec scp" + words_of(words), log_file()));
}

void RemoteParticipant::require_program() const {
  for (const char* client : {"ssh", "scp"}) {
    if (!find_program(client))
      refuse(fmt::format("there is no program {} on this host; install openssh-client", client));
  }
  const Answer answer = ssh("mkdir -p " + quoted(run_folder() + "/given") + " && " + quoted(program()) + " --version");
  if (answer.exit_code == kSshFailed) {
    const std::string said = joined(answer.lines);
    refuse(fmt::format("the host was not reached by ssh without a password: {}; {}", said,
                       ssh_advice(said, host_.destination)));
  }
  if (answer.exit_code == kNotFound || answer.exit_code == kNotExecutable) {
    refuse(fmt::format("there is no program {}; install the same version there, or name its folder as `programs`",
                       program()));
  }
  if (answer.exit_code != 0) refuse(fmt::format("cannot be prepared: {}", joined(answer.lines)));
  const std::string expected = fmt::format("{} {}", name(host_.role), software_version());
  if (std::ranges::find(answer.lines, expected) == answer.lines.end()) {
    refuse(fmt::format("another version: expected '{}', found '{}'; install the same version there", expected,
                       joined(answer.lines)));
  }
}

void RemoteParticipant::copy_there(const std::vector<std::string>& files, const std::filesystem::path& network_file) {
  std::set<std::string> tops;  // a folder once, with all that is below
  for (const std::string& file : files) tops.insert((run_directory_ / *std::filesystem::path{file}.begin()).string());
  std::vector<std::string> arguments{tops.begin(), tops.end()};
  arguments.push_back(host_.destination + ":" + run_folder() + "/given/");
  Answer answer = scp(arguments);
  if (answer.exit_code == 0 && has_network_file_) {
    answer = scp({network_file.string(), host_.destination + ":" + run_folder() + "/given/network.yaml"});
  }
  if (answer.exit_code != 0) refuse("the scenario could not be copied there: " + joined(answer.lines));
}

void RemoteParticipant::require_same(const std::vector<std::string>& files) const {
  const std::string digests = "sha256sum --" + words_of(files);
  const Answer here = run(shell("cd " + quoted(run_directory_.string()) + " && " + digests, log_file()));
  const Answer there = ssh("cd " + quoted(run_folder() + "/given") + " && " + digests);
  if (here.exit_code != 0) refuse("the SHA-256 of the scenario could not be computed here: " + joined(here.lines));
  if (there.exit_code != 0) refuse("the copy of the scenario could not be checked: " + joined(there.lines));
  for (const std::string& line : here.lines) {
    if (std::ranges::find(there.lines, line) != there.lines.end()) continue;
    refuse(
        fmt::format("the copy of the scenario there differs from the one here, in SHA-256 and file: {}; is the disk "
                    "there full?",
                    line));
  }
}

void RemoteParticipant::prepare(const Scenario& scenario, const std::filesystem::path& network_file) {
  has_network_file_ = !network_file.empty() && std::ranges::find(host_.arguments, "--network") == host_.arguments.end();
  const std::vector<std::string> files = files_of(scenario, host_);
  require_program();
  copy_there(files, network_file);
  require_same(files);
}

std::unique_ptr<ChildProcess> RemoteParticipant::start(const Scenario& scenario,
                                                       const std::vector<std::string>& network_arguments) const {
  std::vector<std::string> arguments{
      "--scenario", run_folder() + "/given/scenario.yaml", "--id", host_.id, "--out", run_folder(), "--quiet"};
  if (has_network_file_) arguments.insert(arguments.end(), {"--network", run_folder() + "/given/network.yaml"});
  arguments.insert(arguments.end(), network_arguments.begin(), network_arguments.end());
  arguments.insert(arguments.end(), host_.arguments.begin(), host_.arguments.end());
  // The shell there waits for the participant. Beside it another one waits for the end of its input, which is the end
  // of the connection.
  const std::string script = fmt::format(
      "exec 3<&0; {0}{1} </dev/null 3<&- & p=$!; "
      "{{ read -r end <&3; kill -TERM $p; sleep {2} 3<&-; kill -KILL $p; }} >/dev/null 2>&1 & w=$!; "
      "exec 3<&-; wait $p; code=$?; kill $w 2>/dev/null; exit $code",
      quoted(program()), words_of(arguments), kStopMargin_s + static_cast<int>(to_seconds(scenario.timeouts.stop)));
  std::vector<std::string> words = kSshOptions;
  words.insert(words.end(), {host_.destination, "sh -c " + quoted(script)});
  const int input = input_->ends[0];
  ChildStart start = shell(fmt::format("exec ssh{} <&{}", words_of(words), input), log_file());
  start.kept_descriptors = {input};
  return std::make_unique<ChildProcess>(host_.id, start);
}

std::string RemoteParticipant::fetch() const {
  const std::filesystem::path file = run_file(run_directory_, host_.id);
  const std::string there = host_.destination + ":" + run_folder() + "/" + file.filename().string();
  try {
    // The log of the participant is already in its place.
    ChildStart start = shell("exec scp -q -B -o ConnectTimeout=10" + words_of({there, file.string()}),
                             run_directory_ / (host_.id + ".fetch.log"));
    const Answer answer = run(start);
    if (answer.exit_code == 0) {
      std::filesystem::remove(start.log_file);
      return {};
    }
    return fmt::format("{}: its recording was not fetched ({}); it is at {}: copy it to {}", host_.id,
                       joined(answer.lines), there, file.string());
  } catch (const std::exception& error) {
    return fmt::format("{}; the recording is at {}: copy it to {}", error.what(), there, file.string());
  }
}

}  // namespace hybridtest
