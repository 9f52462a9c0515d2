#include "diagnosis/verdict/repeatability.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "diagnosis/localisation/floor.hpp"

namespace hybridtest {
namespace {

/// A segment's signals with the model's residual.
struct Residual {
  const Segment* segment = nullptr;
  std::vector<double> input_m;
  std::vector<double> residual;

  [[nodiscard]] GapSignals signals() const { return {segment->period_s, input_m, segment->measured, residual}; }
};

Residual residual_of(const SiteModel& model, const Segment& segment) {
  Residual result{&segment, std::vector<double>(segment.input.size()), predict(model, segment)};
  std::ranges::transform(segment.input, result.input_m.begin(), &Motion::displacement_m);
  std::ranges::transform(segment.measured, result.residual, result.residual.begin(), std::minus{});
  return result;
}

std::optional<RepeatabilityFloor> floor_of(const Residual& residual, const std::vector<Residual>& all) {
  for (const Residual& other : all) {
    const bool is_again = &other != &residual && other.segment->from == residual.segment->from &&
                          other.segment->to == residual.segment->to;
    if (!is_again) continue;
    if (const auto floor = floor_of_repetition(residual.signals(), other.signals())) return floor;
  }
  return floor_of_cycles(residual.signals());
}

}  // namespace

void add_repeatability(const SiteModel& model, std::span<const Segment> segments,
                       std::vector<report::InterfaceGap>& where) {
  std::vector<Residual> residuals;
  for (const Segment& segment : segments) residuals.push_back(residual_of(model, segment));
  for (const Residual& residual : residuals) {
    const auto gap = std::ranges::find(where, name_of(residual.segment->interface), &report::InterfaceGap::interface);
    const double output = mean_square(residual.segment->measured);
    if (gap == where.end() || !gap->is_judged || output <= 0.0) continue;
    const std::optional<RepeatabilityFloor> floor = floor_of(residual, residuals);
    if (!floor) continue;
    const double nrmse = floor->rms / std::sqrt(output);
    if (gap->repeatability && gap->repeatability->nrmse >= nrmse) continue;
    gap->repeatability = report::Repeatability{nrmse, std::string{name_of(floor->source)}};
  }
}

}  // namespace hybridtest
