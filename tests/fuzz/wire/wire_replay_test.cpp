#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/random.hpp"
#include "tests/fuzz/wire/wire_fuzz.hpp"

namespace hybridtest {
namespace {

/// Files of the corpus by name, sorted, so that a seed means the same everywhere.
std::map<std::string, std::string> corpus() {
  std::map<std::string, std::string> files;
  const std::filesystem::path folder = std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "tests/fuzz/corpus/wire";
  for (const auto& entry : std::filesystem::directory_iterator{folder}) {
    std::ifstream stream{entry.path(), std::ios::binary};
    files[entry.path().filename().string()] =
        std::string{std::istreambuf_iterator<char>{stream}, std::istreambuf_iterator<char>{}};
  }
  return files;
}

WireFuzzOutcome run(std::string_view bytes) {
  return fuzz_wire(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

/// One change as a fuzzer makes it: a bit, a byte, a length, a range cut or repeated.
void change(std::string& bytes, Random& random) {
  const auto any_position = [&] { return static_cast<std::size_t>(random.below(bytes.size() + 1)); };
  const std::size_t at = any_position();
  switch (random.below(6)) {
    case 0: bytes.resize(at); break;
    case 1: bytes.erase(at, static_cast<std::size_t>(random.below(9))); break;
    case 2: bytes.insert(at, bytes.substr(any_position(), 8)); break;
    case 3: bytes.replace(at, 4, std::string(4, '\xFF')); break;  // a huge length, count or enumerator
    case 4: bytes.replace(at, at < bytes.size() ? 1 : 0, 1, static_cast<char>(random.below(256))); break;
    default:
      if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
  }
}

TEST(WireFuzzReplay, CorpusFilesBehaveAsNamed) {
  const std::map<std::string, WireFuzzOutcome> expected = {{"accepted", WireFuzzOutcome::accepted},
                                                           {"refused", WireFuzzOutcome::refused},
                                                           {"unreadable", WireFuzzOutcome::unreadable}};
  const auto files = corpus();
  ASSERT_GE(files.size(), 10U);
  for (const auto& [name, bytes] : files) {
    const auto outcome = expected.find(name.substr(0, name.find('_')));
    ASSERT_NE(outcome, expected.end()) << name;
    EXPECT_EQ(run(bytes), outcome->second) << name;
  }
}

TEST(WireFuzzReplay, SurvivesMutationsOfTheCorpus) {
  constexpr std::uint64_t kSeed = 1;
  constexpr std::uint64_t kMutations = 20000;
  std::vector<std::string> inputs;
  for (const auto& [name, bytes] : corpus()) inputs.push_back(bytes);
  std::map<WireFuzzOutcome, int> outcomes;
  for (std::uint64_t number = 0; number < kMutations; ++number) {
    Random random{kSeed, number};
    std::string bytes = inputs[static_cast<std::size_t>(random.below(inputs.size()))];
    const std::uint64_t changes = 1 + random.below(3);
    for (std::uint64_t i = 0; i < changes; ++i) change(bytes, random);
    try {
      ++outcomes[run(bytes)];
    } catch (const std::exception& error) {
      FAIL() << "mutation " << number << " of seed " << kSeed << ": " << error.what();
    }
  }
  // Mutations that all end the same way would test nothing.
  EXPECT_GT(outcomes[WireFuzzOutcome::unreadable], 2000);
  EXPECT_GT(outcomes[WireFuzzOutcome::refused], 1000);
  EXPECT_GT(outcomes[WireFuzzOutcome::accepted], 2000);
}

}  // namespace
}  // namespace hybridtest
