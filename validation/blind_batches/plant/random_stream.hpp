#pragma once

#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

namespace hybridtest::blind {

/// Random numbers of the blind plant: std::mt19937_64, whose output the standard fixes, under
/// distributions of its own, so that a seed repeats a batch to the last byte anywhere.
class RandomStream {
 public:
  /// @param purpose   "site", "excitation" …: streams of one seed and different purposes are unrelated, so that
  ///                  what is drawn for one purpose cannot show in another.
  RandomStream(std::uint64_t seed, std::uint64_t index, std::string_view purpose);

  [[nodiscard]] double uniform(double low, double high);
  /// Uniform in the logarithm; both ends positive.
  [[nodiscard]] double log_uniform(double low, double high);
  /// Standard normal (Box and Muller, Ann. Math. Stat. 29, 1958).
  [[nodiscard]] double normal();
  /// 0 to count - 1.
  [[nodiscard]] std::size_t index(std::size_t count);
  /// 0 to weights.size() - 1, each as often as its weight says.
  [[nodiscard]] std::size_t weighted(const std::vector<double>& weights);
  [[nodiscard]] bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  [[nodiscard]] double sign() { return chance(0.5) ? 1.0 : -1.0; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace hybridtest::blind
