#include "diagnosis/identification/repetition.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "diagnosis/localisation/floor.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

/// Each column relative to its own size: a current and a temperature have other units.
bool same_inputs(const InputTable& first, const InputTable& second) {
  if (first.names != second.names) return false;
  const std::size_t size = std::min(first.values.size(), second.values.size());
  const std::size_t columns = first.names.size();
  for (std::size_t column = 0; column < columns; ++column) {
    double squares = 0.0;
    double difference = 0.0;
    for (std::size_t i = column; i < size; i += columns) {
      squares += std::pow(first.values[i], 2);
      difference += std::pow(first.values[i] - second.values[i], 2);
    }
    if (difference > tuning::kSameInput * tuning::kSameInput * squares) return false;
  }
  return true;
}

}  // namespace

bool may_repeat(const Segment& first, const Segment& second) {
  return first.from == second.from && first.to == second.to && !first.history && !second.history &&
         same_inputs(first.inputs, second.inputs);
}

std::vector<double> repetition_floors(std::span<const FitSegment> segments, std::span<const GapSignals> signals) {
  std::vector<double> floors(segments.size(), 0.0);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (std::size_t j = i + 1; j < segments.size(); ++j) {
      if (!may_repeat(segments[i].segment, segments[j].segment)) continue;
      const auto floor = floor_of_repetition(signals[i], signals[j]);
      if (!floor) continue;
      for (const std::size_t k : {i, j}) floors[k] = std::max(floors[k], floor->rms);
    }
  }
  return floors;
}

}  // namespace hybridtest
