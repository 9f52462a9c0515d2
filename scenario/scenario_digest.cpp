#include "scenario/scenario_digest.hpp"

#include <openssl/evp.h>

#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

#include "core/config_error.hpp"

namespace hybridtest {

ScenarioDigest sha256(std::string_view text) {
  ScenarioDigest digest{};
  unsigned length = 0;
  const int done = EVP_Digest(text.data(), text.size(), digest.data(), &length, EVP_sha256(), nullptr);
  if (done != 1 || length != digest.size()) throw std::runtime_error{"SHA-256 of the scenario could not be computed"};
  return digest;
}

ScenarioDigest sha256_of_file(const std::filesystem::path& file) {
  constexpr std::size_t kBlock_bytes = std::size_t{1} << 20U;
  std::ifstream stream{file, std::ios::binary};
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context{EVP_MD_CTX_new(), EVP_MD_CTX_free};
  bool done = context && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  std::vector<char> block(kBlock_bytes);
  while (done && stream) {
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    done = EVP_DigestUpdate(context.get(), block.data(), static_cast<std::size_t>(stream.gcount())) == 1;
  }
  if (!stream.eof()) throw ConfigError{file.string() + ": cannot be read to its end; expected a readable file"};
  ScenarioDigest digest{};
  unsigned length = 0;
  done = done && EVP_DigestFinal_ex(context.get(), digest.data(), &length) == 1;
  if (!done || length != digest.size()) throw std::runtime_error{file.string() + ": SHA-256 could not be computed"};
  return digest;
}

}  // namespace hybridtest
