#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

namespace hybridtest {

/// The values at some ranks among more values than fit into memory. Exact: the same as after sorting them all.
///
/// The values are handed over in passes, each time all of them, in any order. One pass is enough where few of them
/// differ; otherwise a pass counts those with the same leading bits, and the next one looks at the bits behind, among
/// the values that share the leading bits with the wanted one (radix selection). Memory does not grow with the values.
class RankedValues {
 public:
  /// @param wanted   the wanted ranks among `count` values, from 0; called once, with at least one value.
  explicit RankedValues(std::function<std::vector<std::size_t>(std::size_t count)> wanted);

  /// @param value   finite.
  void add(double value);
  /// Ends a pass. @return whether another one is needed.
  bool end_pass();

  /// After the last pass, in the order of the wanted ranks; empty without any values.
  [[nodiscard]] const std::vector<double>& values() const noexcept { return values_; }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }

 private:
  /// The values whose leading bits are those of `prefix`, while it is not known which of them has the wanted ranks.
  struct Search {
    std::uint64_t prefix = 0;  // the leading bits, the others 0
    int known_bits = 0;
    std::vector<std::pair<std::size_t, std::size_t>> wanted{};     // position in values_, and rank among these values
    std::unordered_map<std::uint64_t, std::uint64_t> differing{};  // each value and how often, while they are few
    std::vector<std::uint64_t> counts{};                           // by the bits behind the prefix, once they are many

    void add(std::uint64_t key);
  };

  void look_closer(Search& search, std::vector<Search>& next);

  std::function<std::vector<std::size_t>(std::size_t)> wanted_;
  std::vector<Search> searches_;
  std::vector<double> values_;
  std::size_t count_ = 0;
  bool is_first_pass_ = true;
};

}  // namespace hybridtest
