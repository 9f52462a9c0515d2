#include <gtest/gtest.h>

#include <array>
#include <map>
#include <string>
#include <string_view>

#include "core/random.hpp"
#include "tests/fuzz/ground_motion_fuzz.hpp"
#include "tests/fuzz/replay.hpp"

namespace hybridtest {
namespace {

/// One change as a fuzzer makes it: a byte, a piece of a header or number, a range cut or repeated.
void change(std::string& text, Random& random) {
  static constexpr std::array<std::string_view, 22> kPieces = {
      "NPTS",         "DT",     "=",    ",", " ",   "\n",  "\r",
      "\r\n",         "-",      "E",    ".", "1e9", "nan", "inf",
      "1e308",        "1e-320", "\xFF", "#", "0",   "SEC", "UNITS OF CM/S ",
      "VELOCITY TIME"};
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

TEST(GroundMotionFuzzReplay, CorpusFilesBehaveAsNamed) {
  test::expect_outcomes_as_named("ground_motion", fuzz_ground_motion,
                                 std::map<std::string, bool>{{"accepted", true}, {"refused", false}});
}

TEST(GroundMotionFuzzReplay, SurvivesMutationsOfTheCorpus) {
  const auto texts = test::to_mutate("ground_motion", 4);
  auto outcomes = test::outcomes_of_mutations(4000, fuzz_ground_motion,
                                              [&](Random& random) { return test::changed(texts, 3, change, random); });
  // Mutations that all end the same way would test nothing.
  EXPECT_GT(outcomes[true], 400);
  EXPECT_GT(outcomes[false], 400);
}

}  // namespace
}  // namespace hybridtest
