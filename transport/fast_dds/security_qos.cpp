#include "transport/fast_dds/security_qos.hpp"

#include <string>

#include "transport/fast_dds/credentials.hpp"

namespace hybridtest::fast_dds {

void add_security(const std::filesystem::path& credentials, eprosima::fastdds::dds::DomainParticipantQos& qos) {
  static_cast<void>(require_valid_credentials(credentials));
  const Credentials files = credentials_in(credentials);
  const auto set = [&qos](const std::string& name, const std::string& value) {
    qos.properties().properties().emplace_back(name, value);
  };
  const auto set_file = [&set](const std::string& name, const std::filesystem::path& file) {
    set(name, "file://" + file.string());
  };
  const std::string identity = "dds.sec.auth.builtin.PKI-DH.";
  set("dds.sec.auth.plugin", "builtin.PKI-DH");
  set_file(identity + "identity_ca", files.identity_ca);
  set_file(identity + "identity_certificate", files.certificate);
  set_file(identity + "private_key", files.private_key);
  const std::string access = "dds.sec.access.builtin.Access-Permissions.";
  set("dds.sec.access.plugin", "builtin.Access-Permissions");
  set_file(access + "permissions_ca", files.permissions_ca);
  set_file(access + "governance", files.governance);
  set_file(access + "permissions", files.permissions);
  set("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
}

}  // namespace hybridtest::fast_dds
