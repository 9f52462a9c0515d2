#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/random.hpp"
#include "tests/fuzz/recording_fuzz.hpp"

namespace hybridtest {
namespace {

/// Files of the corpus by name, sorted, so that a seed means the same everywhere.
std::map<std::string, std::string> corpus() {
  std::map<std::string, std::string> files;
  const std::filesystem::path folder = std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "tests/fuzz/corpus/recording";
  for (const auto& entry : std::filesystem::directory_iterator{folder}) {
    std::ifstream stream{entry.path(), std::ios::binary};
    files[entry.path().filename().string()] =
        std::string{std::istreambuf_iterator<char>{stream}, std::istreambuf_iterator<char>{}};
  }
  return files;
}

bool run(std::string_view text) {
  return fuzz_recording(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

/// One change as a fuzzer makes it: a byte, a piece of a header or number, a range cut or repeated.
void change(std::string& text, Random& random) {
  static constexpr std::array<std::string_view, 16> kPieces = {
      "time_s", "measured_force_n", "_2", ",",   ";", "\n", "\r\n", "-", "e", ".", "1e9", "nan",
      "inf",    "1e-320",           "\"", "\xFF"};
  const auto at = static_cast<std::size_t>(random.below(text.size() + 1));
  const auto piece = kPieces[static_cast<std::size_t>(random.below(kPieces.size()))];
  switch (random.below(5)) {
    case 0: text.insert(at, piece); break;
    case 1: text.erase(at, static_cast<std::size_t>(random.below(12))); break;
    case 2: text.insert(at, text.substr(static_cast<std::size_t>(random.below(text.size() + 1)), 20)); break;
    case 3: text.replace(at, at < text.size() ? 1 : 0, 1, static_cast<char>(random.below(256))); break;
    default: text.replace(at, at < text.size() ? 1 : 0, 1, static_cast<char>('0' + random.below(10))); break;
  }
}

TEST(RecordingFuzzReplay, CorpusFilesBehaveAsNamed) {
  const auto files = corpus();
  ASSERT_GE(files.size(), 10U);
  for (const auto& [name, text] : files) {
    const bool is_expected = name.starts_with("accepted_");
    ASSERT_TRUE(is_expected || name.starts_with("refused_")) << name;
    EXPECT_EQ(run(text), is_expected) << name;
  }
}

TEST(RecordingFuzzReplay, SurvivesMutationsOfTheCorpus) {
  constexpr std::uint64_t kSeed = 1;
  constexpr std::uint64_t kMutations = 4000;
  std::vector<std::string> texts;
  for (const auto& [name, text] : corpus()) texts.insert(texts.end(), name.starts_with("accepted_") ? 4 : 1, text);
  int accepted = 0;
  int refused = 0;
  for (std::uint64_t number = 0; number < kMutations; ++number) {
    Random random{kSeed, number};
    std::string text = texts[static_cast<std::size_t>(random.below(texts.size()))];
    const std::uint64_t changes = 1 + random.below(3);
    for (std::uint64_t i = 0; i < changes; ++i) change(text, random);
    try {
      ++(run(text) ? accepted : refused);
    } catch (const std::exception& error) {
      FAIL() << "mutation " << number << " of seed " << kSeed << ": " << error.what() << '\n' << text;
    }
  }
  // Mutations that all end the same way would test nothing.
  EXPECT_GT(accepted, 150);
  EXPECT_GT(refused, 400);
}

}  // namespace
}  // namespace hybridtest
