#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/assert.hpp"
#include "core/random.hpp"
#include "tests/fuzz/config_fuzz.hpp"
#include "tests/fuzz/replay.hpp"

namespace hybridtest {
namespace {

/// Changes a text as a fuzzer does: bytes, ranges, pieces of YAML, parts of other texts.
class Mutator {
 public:
  Mutator(Random& random, const std::vector<std::string>& texts) : random_{random}, texts_{texts} {}

  [[nodiscard]] std::string next() {
    std::string text = any(texts_);
    const std::uint64_t changes = 1 + random_.below(2);
    for (std::uint64_t i = 0; i < changes; ++i) change(text);
    return text;
  }

 private:
  template <class Container>
  [[nodiscard]] typename Container::value_type any(const Container& container) {
    return container[static_cast<std::size_t>(random_.below(container.size()))];
  }

  [[nodiscard]] std::size_t position_in(const std::string& text) {
    return static_cast<std::size_t>(random_.below(text.size() + 1));
  }

  [[nodiscard]] std::string piece_of(const std::string& text) {
    return text.substr(position_in(text), static_cast<std::size_t>(random_.below(40)));
  }

  void change(std::string& text) {
    static constexpr std::array<std::string_view, 44> kPieces = {
        "a",  "b: ",  ": ",  ":",  "- ",    "? ",   "[",          "]",        "{",    "}",     ",",
        "\n", "\n  ", " ",   "\t", "!",     "!!s ", "!<x>",       "&x ",      "*x",   "|\n",   ">-\n",
        "\"", "'",    "#",   " #", "---\n", "...",  "\\",         "~",        "null", "true",  "1e999",
        "-1", ".nan", "0x1", "@",  "<<: ",  "\r\n", "%TAG ! b\n", "\xC3\xA9", "\xFF", "#set ", "="};
    const std::size_t at = position_in(text);
    switch (random_.below(6)) {
      case 0: text.insert(at, any(kPieces)); break;
      case 1: text.erase(at, static_cast<std::size_t>(random_.below(20))); break;
      case 2: text.insert(at, piece_of(text)); break;
      case 3: text.insert(at, piece_of(any(texts_))); break;
      case 4: text.replace(at, at < text.size() ? 1 : 0, 1, static_cast<char>(random_.below(256))); break;
      default: text.replace(at, at < text.size() ? 1 : 0, any(kPieces)); break;
    }
  }

  Random& random_;
  const std::vector<std::string>& texts_;
};

/// The input that was running when an assertion failed, for the console.
void print_input(void* text) noexcept {
  const auto& input = *static_cast<const std::string*>(text);
  std::fprintf(stderr, "input of %zu bytes:\n%s\n", input.size(), input.c_str());
}

TEST(ConfigFuzzReplay, CorpusFilesBehaveAsNamed) {
  const std::map<std::string, ConfigFuzzOutcome> expected = {{"accepted", ConfigFuzzOutcome::accepted},
                                                             {"errors", ConfigFuzzOutcome::with_errors},
                                                             {"refused", ConfigFuzzOutcome::refused}};
  test::expect_outcomes_as_named("config", fuzz_config, expected);
}

TEST(ConfigFuzzReplay, SurvivesMutationsOfTheCorpus) {
  const auto texts = test::to_mutate("config", 8);
  std::string text;
  set_assert_action(print_input, &text);
  auto outcomes = test::outcomes_of_mutations(2000, fuzz_config, [&](Random& random) {
    return text = Mutator{random, texts}.next();
  });
  set_assert_action(nullptr, nullptr);
  // Mutations that all end the same way would test nothing.
  EXPECT_GT(outcomes[ConfigFuzzOutcome::refused], 100);
  EXPECT_GT(outcomes[ConfigFuzzOutcome::with_errors], 100);
  EXPECT_GT(outcomes[ConfigFuzzOutcome::accepted], 50);
}

}  // namespace
}  // namespace hybridtest
