#include "recording/summary/ranked_values.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

constexpr int kKeyBits = 64;
constexpr int kBitsPerPass = 12;
/// Different values that are counted one by one: the round trips of a simulated test, the intervals of a control loop.
constexpr std::size_t kDifferingMax = 4096;
constexpr std::uint64_t kSign = std::uint64_t{1} << 63U;

/// Ordered as the numbers are.
std::uint64_t key_of(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value + 0.0);  // -0 becomes 0: they are equal
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}

double value_of(std::uint64_t key) { return std::bit_cast<double>((key & kSign) != 0 ? key ^ kSign : ~key); }

/// The leading bits of a key.
std::uint64_t leading(std::uint64_t key, int bits) { return bits == 0 ? 0 : key >> (kKeyBits - bits); }

int bits_after(int known_bits) { return std::min(kBitsPerPass, kKeyBits - known_bits); }

}  // namespace

void RankedValues::Search::add(std::uint64_t key) {
  if (leading(key, known_bits) != leading(prefix, known_bits)) return;
  const int bits = bits_after(known_bits);
  const auto bucket = [&](std::uint64_t one) {
    return static_cast<std::size_t>(leading(one, known_bits + bits) & ((std::uint64_t{1} << bits) - 1));
  };
  if (!counts.empty()) {
    ++counts[bucket(key)];
    return;
  }
  ++differing[key];
  if (differing.size() <= kDifferingMax) return;
  counts.assign(std::size_t{1} << bits, 0);
  for (const auto& [value, count] : differing) counts[bucket(value)] += count;
  differing = {};
}

RankedValues::RankedValues(std::function<std::vector<std::size_t>(std::size_t)> wanted)
    : wanted_{std::move(wanted)}, searches_(1) {}

void RankedValues::add(double value) {
  if (is_first_pass_) ++count_;
  const std::uint64_t key = key_of(value);
  for (Search& search : searches_) search.add(key);
}

/// Finds the wanted values, or the leading bits of them.
void RankedValues::look_closer(Search& search, std::vector<Search>& next) {
  if (search.counts.empty()) {
    std::vector<std::pair<std::uint64_t, std::uint64_t>> sorted{search.differing.begin(), search.differing.end()};
    std::ranges::sort(sorted);
    for (const auto& [position, rank] : search.wanted) {
      std::uint64_t before = 0;
      const auto found = std::ranges::find_if(sorted, [&, wanted = rank](const auto& value) {
        before += value.second;
        return before > wanted;
      });
      HYBRIDTEST_ASSERT(found != sorted.end());
      values_[position] = value_of(found->first);
    }
    return;
  }
  const int bits = search.known_bits + bits_after(search.known_bits);
  for (const auto& [position, rank] : search.wanted) {
    std::uint64_t before = 0;
    std::size_t bucket = 0;
    while (before + search.counts[bucket] <= rank) before += search.counts[bucket++];
    const std::uint64_t prefix = search.prefix | std::uint64_t{bucket} << (kKeyBits - bits);
    if (bits == kKeyBits) {
      values_[position] = value_of(prefix);
      continue;
    }
    const auto same = std::ranges::find(next, prefix, &Search::prefix);
    Search& closer = same != next.end() ? *same : next.emplace_back(Search{.prefix = prefix, .known_bits = bits});
    closer.wanted.emplace_back(position, rank - before);
  }
}

bool RankedValues::end_pass() {
  if (std::exchange(is_first_pass_, false)) {
    if (count_ == 0) {
      searches_.clear();
      return false;
    }
    const std::vector<std::size_t> ranks = wanted_(count_);
    values_.resize(ranks.size());
    for (std::size_t i = 0; i < ranks.size(); ++i) searches_.front().wanted.emplace_back(i, ranks[i]);
  }
  std::vector<Search> next;
  for (Search& search : searches_) look_closer(search, next);
  searches_ = std::move(next);
  return !searches_.empty();
}

}  // namespace hybridtest
