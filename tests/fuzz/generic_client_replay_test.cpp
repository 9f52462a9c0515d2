#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/random.hpp"
#include "tests/fuzz/generic_client_fuzz.hpp"

namespace hybridtest {
namespace {

/// Files of the corpus by name, sorted, so that a seed means the same everywhere.
std::map<std::string, std::string> corpus() {
  std::map<std::string, std::string> files;
  const std::filesystem::path folder =
      std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "tests/fuzz/corpus/generic_client";
  for (const auto& entry : std::filesystem::directory_iterator{folder}) {
    std::ifstream stream{entry.path(), std::ios::binary};
    files[entry.path().filename().string()] =
        std::string{std::istreambuf_iterator<char>{stream}, std::istreambuf_iterator<char>{}};
  }
  return files;
}

GenericClientOutcome run(std::string_view bytes) {
  return fuzz_generic_client(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

/// One change as a network or a program makes it: a byte or a bit, a range cut, repeated or moved.
void change(std::string& bytes, Random& random) {
  const auto at = static_cast<std::size_t>(random.below(bytes.size() + 1));
  switch (random.below(4)) {
    case 0: bytes.erase(at, static_cast<std::size_t>(random.below(64))); break;
    case 1: bytes.insert(at, bytes.substr(static_cast<std::size_t>(random.below(bytes.size() + 1)), 64)); break;
    case 2: bytes.replace(at, at < bytes.size() ? 1 : 0, 1, static_cast<char>(random.below(256))); break;
    default:
      if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
      break;
  }
}

TEST(GenericClientFuzzReplay, CorpusFilesBehaveAsNamed) {
  const std::map<std::string, GenericClientOutcome> expected = {{"waiting", GenericClientOutcome::waiting},
                                                                {"refused", GenericClientOutcome::refused},
                                                                {"accepted", GenericClientOutcome::accepted},
                                                                {"lost", GenericClientOutcome::lost}};
  const auto files = corpus();
  ASSERT_GE(files.size(), 10U);
  for (const auto& [name, bytes] : files) {
    const auto outcome = expected.find(name.substr(0, name.find('_')));
    ASSERT_NE(outcome, expected.end()) << name;
    EXPECT_EQ(run(bytes), outcome->second) << name;
  }
}

TEST(GenericClientFuzzReplay, SurvivesMutationsOfTheCorpus) {
  const auto files = corpus();
  std::vector<std::string> texts;
  for (const auto& [name, bytes] : files) texts.push_back(bytes);
  std::map<GenericClientOutcome, int> outcomes;
  for (std::uint64_t number = 0; number < 5000; ++number) {
    Random random{1, number};
    std::string bytes = texts[static_cast<std::size_t>(random.below(texts.size()))];
    for (std::uint64_t changes = random.below(3) + 1; changes > 0; --changes) change(bytes, random);
    ++outcomes[run(bytes)];
  }
  // Mutations that all end the same way would test nothing.
  for (const auto& [name, outcome] :
       {std::pair{"refused", GenericClientOutcome::refused}, std::pair{"accepted", GenericClientOutcome::accepted},
        std::pair{"lost", GenericClientOutcome::lost}}) {
    EXPECT_GT(outcomes[outcome], 100) << name;
  }
}

}  // namespace
}  // namespace hybridtest
