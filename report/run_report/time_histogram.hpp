#pragma once

#include <cstdint>
#include <vector>

namespace hybridtest::run_report {

/// Counts times in bins of equal width on a logarithmic axis.
class TimeHistogram {
 public:
  TimeHistogram();

  /// Times beyond the range of tuning.hpp belong to the bins at its ends; those that are not finite are left out.
  void add(double time_us, double count = 1.0);

  [[nodiscard]] double count() const noexcept { return count_; }

  /// An outline to draw: share [%] over time [us], from the first to the last bin that has any.
  struct Outline {
    std::vector<double> time_us;
    std::vector<double> percent;
  };
  [[nodiscard]] Outline outline() const;

 private:
  std::vector<double> counts_;
  double count_ = 0.0;
};

}  // namespace hybridtest::run_report
