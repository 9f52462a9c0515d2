#include "scenario/scenario_digest.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "core/config_error.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

namespace hybridtest {
namespace {

std::string hexadecimal(const ScenarioDigest& digest) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : digest) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 0xfU];
  }
  return text;
}

// Examples that NIST publishes with FIPS 180-4.
TEST(ScenarioDigest, IsSha256) {
  EXPECT_EQ(hexadecimal(sha256("")), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hexadecimal(sha256("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hexadecimal(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

/// The same examples, the one of a million letters, and a file that is longer than a block of the reader.
TEST(ScenarioDigest, OfAFileIsSha256) {
  const TemporaryDirectory directory;
  const auto of_file = [&](const std::string& content) {
    std::ofstream{directory / "content", std::ios::binary | std::ios::trunc} << content;
    return hexadecimal(sha256_of_file(directory / "content"));
  };
  EXPECT_EQ(of_file(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(of_file("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(of_file(std::string(1'000'000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  const std::size_t block_and_more = (std::size_t{1} << 20U) + 7;
  const std::string large(block_and_more, 'b');
  EXPECT_EQ(of_file(large), hexadecimal(sha256(large)));
}

TEST(ScenarioDigest, OfAFileThatCannotBeReadIsAnError) {
  const TemporaryDirectory directory;
  EXPECT_THROW(static_cast<void>(sha256_of_file(directory / "absent")), ConfigError);
}

}  // namespace
}  // namespace hybridtest
