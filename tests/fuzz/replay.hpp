#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/random.hpp"

namespace hybridtest::test {

/// Files of `tests/fuzz/corpus/<folder>` by name, sorted, so that a seed means the same everywhere.
inline std::map<std::string, std::string> corpus(std::string_view folder) {
  std::map<std::string, std::string> files;
  const std::filesystem::path path = std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "tests/fuzz/corpus" / folder;
  for (const auto& entry : std::filesystem::directory_iterator{path}) {
    std::ifstream stream{entry.path(), std::ios::binary};
    files[entry.path().filename().string()] =
        std::string{std::istreambuf_iterator<char>{stream}, std::istreambuf_iterator<char>{}};
  }
  return files;
}

/// Gives bytes, which are kept as text here, to what takes them as a fuzzer does.
template <class Fuzzed>
auto run(Fuzzed fuzzed, std::string_view text) {
  return fuzzed(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

/// Each file of a corpus has the outcome that its name begins with.
/// @param expected   outcomes by the part of the name before the first `_`.
template <class Fuzzed, class Outcome>
void expect_outcomes_as_named(std::string_view folder, Fuzzed fuzzed, const std::map<std::string, Outcome>& expected) {
  const auto files = corpus(folder);
  ASSERT_GE(files.size(), 10U);
  for (const auto& [name, text] : files) {
    const auto outcome = expected.find(name.substr(0, name.find('_')));
    ASSERT_NE(outcome, expected.end()) << name;
    EXPECT_EQ(run(fuzzed, text), outcome->second) << name;
  }
}

/// The inputs of a corpus, the accepted ones several times: most changes make an accepted input a refused one.
inline std::vector<std::string> to_mutate(std::string_view folder, std::size_t times_accepted = 1) {
  std::vector<std::string> texts;
  for (const auto& [name, text] : corpus(folder)) {
    texts.insert(texts.end(), name.starts_with("accepted_") ? times_accepted : 1, text);
  }
  return texts;
}

/// Runs mutations 0 to `count` - 1; an exception fails the test and shows the input.
/// @param mutated   makes the input from its random numbers.
/// @return how often each outcome came.
template <class Fuzzed, class Mutated>
auto outcomes_of_mutations(std::uint64_t count, Fuzzed fuzzed, Mutated mutated) {
  constexpr std::uint64_t kSeed = 1;
  std::map<std::invoke_result_t<Fuzzed, const std::uint8_t*, std::size_t>, int> outcomes;
  for (std::uint64_t number = 0; number < count; ++number) {
    Random random{kSeed, number};
    const std::string text = mutated(random);
    try {
      ++outcomes[run(fuzzed, text)];
    } catch (const std::exception& error) {
      ADD_FAILURE() << "mutation " << number << " of seed " << kSeed << ": " << error.what() << '\n' << text;
      break;
    }
  }
  return outcomes;
}

/// One of the texts with one to `changes_max` changes.
template <class Change>
std::string changed(const std::vector<std::string>& texts, std::uint64_t changes_max, Change change, Random& random) {
  std::string text = texts[static_cast<std::size_t>(random.below(texts.size()))];
  for (std::uint64_t changes = 1 + random.below(changes_max); changes > 0; --changes) change(text, random);
  return text;
}

}  // namespace hybridtest::test
