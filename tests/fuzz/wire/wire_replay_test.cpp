#include <gtest/gtest.h>

#include <map>
#include <string>

#include "core/random.hpp"
#include "tests/fuzz/replay.hpp"
#include "tests/fuzz/wire/wire_fuzz.hpp"

namespace hybridtest {
namespace {

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
  test::expect_outcomes_as_named("wire", fuzz_wire, expected);
}

TEST(WireFuzzReplay, SurvivesMutationsOfTheCorpus) {
  const auto inputs = test::to_mutate("wire");
  auto outcomes = test::outcomes_of_mutations(20000, fuzz_wire,
                                              [&](Random& random) { return test::changed(inputs, 3, change, random); });
  // Mutations that all end the same way would test nothing.
  EXPECT_GT(outcomes[WireFuzzOutcome::unreadable], 2000);
  EXPECT_GT(outcomes[WireFuzzOutcome::refused], 1000);
  EXPECT_GT(outcomes[WireFuzzOutcome::accepted], 2000);
}

}  // namespace
}  // namespace hybridtest
