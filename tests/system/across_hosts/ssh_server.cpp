#include "tests/system/across_hosts/ssh_server.hpp"

#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>

#include "tests/system/across_hosts/across_hosts_fixture.hpp"

namespace hybridtest {
namespace {

constexpr const char* kServer = "/usr/sbin/sshd";
constexpr std::chrono::seconds kServerPatience{20};

void write_script(const std::filesystem::path& file, const std::string& text) {
  std::ofstream{file} << "#!/bin/sh\n" << text;
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
}

}  // namespace

SshServer::SshServer(const std::filesystem::path& directory) : directory_{directory} {
  std::filesystem::create_directories(programs());
  for (const char* needed : {kServer, "/usr/bin/ssh", "/usr/bin/scp", "/usr/bin/ssh-keygen"}) {
    if (std::filesystem::exists(needed)) continue;
    why_not_ = std::string{needed} + " is not installed (Debian: openssh-server, openssh-client)";
    return;
  }
  make_keys();
  write_configurations(free_port());
  start();
}

void SshServer::make_keys() {
  const auto make = [&](const std::string& name) {
    const std::string file = (directory_ / name).string();
    const std::string command = "ssh-keygen -q -t ed25519 -N '' -f '" + file + "' </dev/null >/dev/null 2>&1";
    if (std::system(command.c_str()) != 0) why_not_ = "ssh-keygen made no key";
  };
  for (const char* name : {"host_key", "key", "other_key"}) make(name);
  if (why_not_.empty()) std::filesystem::copy_file(directory_ / "key.pub", directory_ / "authorized_keys");
}

void SshServer::write_configurations(int port) const {
  const auto file = [&](const char* name) { return (directory_ / name).string(); };
  const std::string number = std::to_string(port);
  // It offers passwords, so that a client that asks for one is noticed.
  std::ofstream{directory_ / "sshd_config"} << "ListenAddress 127.0.0.1\nPort " << number << "\nHostKey "
                                            << file("host_key") << "\nAuthorizedKeysFile " << file("authorized_keys")
                                            << "\nPidFile none\nUsePAM no\nStrictModes no\nPasswordAuthentication yes\n"
                                            << "PermitRootLogin yes\nSubsystem sftp internal-sftp\n";
  std::ofstream{directory_ / "known_hosts"} << "[127.0.0.1]:" << number << ' ' << text_of(file("host_key.pub"));
  std::ofstream{directory_ / "other_known_hosts"} << "[127.0.0.1]:" << number << ' ' << text_of(file("other_key.pub"));
  // The first value of an option holds; identity files add up.
  std::ofstream{directory_ / "ssh_config"}
      << "Host nobody_there\n  Port " << free_port() << "\nHost wrong_key\n  IdentityFile " << file("other_key")
      << "\nHost * !wrong_key\n  IdentityFile " << file("key") << "\nHost changed_host\n  UserKnownHostsFile "
      << file("other_known_hosts")
      << "\nHost unknown_host\n  UserKnownHostsFile /dev/null\nHost *\n  HostName 127.0.0.1\n  Port " << number
      << "\n  UserKnownHostsFile " << file("known_hosts")
      << "\n  GlobalKnownHostsFile /dev/null\n  IdentitiesOnly yes\n  IdentityAgent none\n";
  for (const std::string client : {"ssh", "scp"}) {
    write_script(programs() / client, "exec /usr/bin/" + client + " -F '" + file("ssh_config") + "' \"$@\"\n");
  }
}

void SshServer::start() {
  if (!why_not_.empty()) return;
  std::string command = std::string{"exec "} + kServer + " -D -e -f '" + (directory_ / "sshd_config").string() + "'";
  std::vector<std::string> words{"-c", command};
  std::string first = "/bin/sh";
  // For root it wants this folder, which only its service makes. Here it is made for this process alone.
  if (geteuid() == 0 && !std::filesystem::exists("/run/sshd")) {
    words.back() = "mount -t tmpfs none /run && mkdir -m 755 /run/sshd && " + command;
    words.insert(words.begin(), {"--mount", first});
    first = "/usr/bin/unshare";
  }
  server_.emplace(first, words, directory_ / "sshd");
  int login = -1;
  const bool answers = wait_until(
      [&] {
        login =
            std::system(("'" + (programs() / "ssh").string() + "' -o BatchMode=yes -o ConnectTimeout=5 lab true >'" +
                         (directory_ / "login.log").string() + "' 2>&1")
                            .c_str());
        return login == 0 || !server_->is_running();
      },
      kServerPatience);
  if (answers && login == 0) return;
  why_not_ = "no login at a server of this user: " + text_of(directory_ / "login.log") + server_->standard_error();
}

void SshServer::cut_connections() const {
  for (const pid_t session : server_->children()) send_signal(session, SIGKILL);
}

}  // namespace hybridtest
