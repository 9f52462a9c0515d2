#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace hybridtest::blind {

/// A figure with its 95 % interval.
struct Estimate {
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
  std::size_t count = 0;  // what it is made from
};

/// Share of successes with Wilson's score interval (J. Am. Stat. Assoc. 22, 1927). Nothing for no trials.
[[nodiscard]] std::optional<Estimate> proportion(std::size_t successes, std::size_t trials);

/// Mean, median … of some of 0 … count - 1, drawn with repetition.
using Statistic = std::function<double(const std::vector<std::size_t>& drawn)>;

/// The statistic of all, with the percentile interval of 2000 bootstrap draws (Efron, Ann. Stat. 7, 1979)
/// from a fixed seed. Nothing for no values.
[[nodiscard]] std::optional<Estimate> bootstrap(std::size_t count, const Statistic& statistic);

[[nodiscard]] std::optional<Estimate> mean(const std::vector<double>& values);
[[nodiscard]] std::optional<Estimate> median(const std::vector<double>& values);

/// A probability that was given, and whether it came true.
struct Forecast {
  double probability = 0.0;
  bool came_true = false;
};

/// Expected calibration error over ten equally wide bins (Naeini, Cooper and Hauskrecht, AAAI 2015).
[[nodiscard]] std::optional<Estimate> calibration_error(const std::vector<Forecast>& forecasts);

}  // namespace hybridtest::blind
