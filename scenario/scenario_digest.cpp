#include "scenario/scenario_digest.hpp"

#include <openssl/evp.h>

#include <stdexcept>

namespace hybridtest {

ScenarioDigest sha256(std::string_view text) {
  ScenarioDigest digest{};
  unsigned length = 0;
  const int done = EVP_Digest(text.data(), text.size(), digest.data(), &length, EVP_sha256(), nullptr);
  if (done != 1 || length != digest.size()) throw std::runtime_error{"SHA-256 of the scenario could not be computed"};
  return digest;
}

}  // namespace hybridtest
