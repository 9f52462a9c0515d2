#include <gtest/gtest.h>

#include <map>
#include <string>

#include "core/random.hpp"
#include "tests/fuzz/generic_client_fuzz.hpp"
#include "tests/fuzz/replay.hpp"

namespace hybridtest {
namespace {

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
  test::expect_outcomes_as_named("generic_client", fuzz_generic_client, expected);
}

TEST(GenericClientFuzzReplay, SurvivesMutationsOfTheCorpus) {
  const auto texts = test::to_mutate("generic_client");
  auto outcomes = test::outcomes_of_mutations(5000, fuzz_generic_client,
                                              [&](Random& random) { return test::changed(texts, 3, change, random); });
  // Mutations that all end the same way would test nothing.
  for (const auto& [name, outcome] :
       {std::pair{"refused", GenericClientOutcome::refused}, std::pair{"accepted", GenericClientOutcome::accepted},
        std::pair{"lost", GenericClientOutcome::lost}}) {
    EXPECT_GT(outcomes[outcome], 100) << name;
  }
}

}  // namespace
}  // namespace hybridtest
