#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hybridtest::fast_dds {

/// Whose credentials they are, as the certificate says.
struct CredentialsOwner {
  std::string test;
  std::string participant;  // id of the scenario, or the name of an operator
};

/// A folder of `launch/security/make_credentials`: the identity of one participant, what it may do, and the authorities
/// that all participants of the test trust. The private key stays in its file; Fast DDS reads it.
struct Credentials {
  std::filesystem::path identity_ca;
  std::filesystem::path permissions_ca;
  std::filesystem::path certificate;
  std::filesystem::path private_key;
  std::filesystem::path governance;
  std::filesystem::path permissions;
};

/// The files of a folder, with absolute paths; looks at none of them.
[[nodiscard]] Credentials credentials_in(const std::filesystem::path& folder);

/// Judges the files as the other participants will, so that errors are told in words before joining.
/// @throws ConfigError at the file, with what to do: missing or unreadable; a private key that others can read or of
///         another certificate; a certificate that has expired, is not valid yet or is of another authority;
///         permissions or governance that the authority of the permissions did not sign.
[[nodiscard]] CredentialsOwner require_valid_credentials(const std::filesystem::path& folder);

/// As require_valid_credentials(), and they are this participant's in this test.
void require_own_credentials(const std::filesystem::path& folder, std::string_view test, std::string_view participant);

}  // namespace hybridtest::fast_dds
