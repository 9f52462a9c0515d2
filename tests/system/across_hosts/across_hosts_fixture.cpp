#include "tests/system/across_hosts/across_hosts_fixture.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>

namespace hybridtest {

using ::testing::Optional;

int free_port() {
  const int probe = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  int port = 0;
  if (bind(probe, reinterpret_cast<const sockaddr*>(&address), size) == 0 &&
      getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size) == 0) {
    port = ntohs(address.sin_port);
  }
  close(probe);
  return port;
}

std::string AcrossHosts::write(const std::string& name, const std::string& text) const {
  const std::filesystem::path file = directory() / name;
  std::ofstream{file} << text;
  return file.string();
}

Arguments AcrossHosts::with_profile(const std::string& body) const {
  Arguments arguments{"--network", write("network.yaml", "schema: hybridtest-network/1\n" + body)};
  std::ranges::copy(network(), std::back_inserter(arguments));
  return arguments;
}

StartedProgram AcrossHosts::start(const std::string& program_name, const std::string& id, const Arguments& more,
                                  const Arguments& before) const {
  Arguments words = before;
  words.push_back(program(program_name).string());
  if (program_name == "hybridtest") {
    words.insert(words.end(), {"doctor", shipped_scenario("two_storey_one_site").string(), "--id", id});
  } else {
    words.insert(words.end(), {"--scenario", shipped_scenario("two_storey_one_site").string(), "--out",
                               (directory() / "run").string(), "--quiet"});
    if (program_name != "coordinator") words.insert(words.end(), {"--id", id});
  }
  words.insert(words.end(), {"--set", "name=" + test_name(), "--set", kDuration, "--set", kPatient});
  words.insert(words.end(), more.begin(), more.end());
  const std::string first = words.front();
  words.erase(words.begin());
  return {first, words, directory() / (program_name + "." + id), {}};
}

std::vector<double> AcrossHosts::displacement(const std::string& run) const {
  return recorded(run).column("coordinator", "steps", "displacement_floor_2_m");
}

std::vector<double> AcrossHosts::simulated(const Arguments& more) const {
  Arguments arguments{"--set", kDuration, "--set", kPatient};
  arguments.insert(arguments.end(), more.begin(), more.end());
  StartedProgram program = start_simulate(shipped_scenario("two_storey_one_site"), "simulated", arguments);
  EXPECT_THAT(program.wait(), Optional(kExitCompleted)) << program.standard_error();
  return displacement("simulated");
}

void AcrossHosts::expect_bits_of_simulate(const Arguments& network_arguments, const Arguments& before_coordinator,
                                          const Arguments& before_others) const {
  StartedProgram coordinator = start("coordinator", "coordinator", network_arguments, before_coordinator);
  StartedProgram site = start("experimental_site", "storey_1", network_arguments, before_others);
  StartedProgram numerical = start("numerical_substructure", "storey_2", network_arguments, before_others);
  ASSERT_THAT(coordinator.wait(), Optional(kExitCompleted)) << coordinator.standard_error();
  EXPECT_THAT(site.wait(), Optional(kExitCompleted)) << site.standard_error();
  EXPECT_THAT(numerical.wait(), Optional(kExitCompleted)) << numerical.standard_error();
  const std::vector<double> values = displacement("run");
  EXPECT_EQ(values.size(), 1001U);
  EXPECT_EQ(values, simulated());
}

bool AcrossHosts::make_certificates(const std::string& folder, const std::vector<std::string>& names) const {
  const std::filesystem::path place = directory() / folder;
  std::filesystem::create_directories(place);
  const auto in_place = [&](const std::string& command) {
    return std::system(("cd '" + place.string() + "' && " + command + " >openssl.log 2>&1").c_str()) == 0;
  };
  const std::string key = "-newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes ";
  bool made =
      in_place("openssl req -x509 " + key + "-days 2 -subj '/CN=authority' -keyout authority.key -out authority.pem");
  for (const std::string& name : names) {
    std::string request = "openssl req " + key;
    request.append("-subj /CN=").append(name).append(" -keyout ").append(name).append(".key -out request.pem");
    std::string certificate = "openssl x509 -req -in request.pem -CA authority.pem -CAkey authority.key ";
    certificate.append("-CAcreateserial -days 2 -out ").append(name).append(".pem");
    made = made && in_place(request) && in_place(certificate);
  }
  return made;
}

}  // namespace hybridtest
