#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "validation/sweep/sweep_table.hpp"

namespace hybridtest {

/// What a curve of fragility counts: cases in which the magnitude of a result is above a limit.
struct Exceedance {
  std::string column;
  double limit = 0.0;
};

/// Reads `column=limit`.
/// @throws ConfigError for a text of another form.
[[nodiscard]] Exceedance read_exceedance(std::string_view text);

/// A share of cases, with the interval that holds the true share in 95 % of all samples of that size
/// (Wilson, 1927, Probable inference, the law of succession, and statistical inference).
struct Share {
  double share = 0.0;
  double low = 0.0;
  double high = 1.0;
};
/// @param of   at least 1.
[[nodiscard]] Share share_of(std::size_t count, std::size_t of);

/// Distributions of the results, and for each key with several numbers as values the share of cases that ended early or
/// went beyond a limit, and the median and the 5 and 95 % quantiles of each peak.
/// @throws ConfigError for an exceedance of a column that is not there.
[[nodiscard]] std::string sweep_page(const SweepPlan& plan, const SweepTable& table,
                                     const std::vector<Exceedance>& exceedances);

}  // namespace hybridtest
