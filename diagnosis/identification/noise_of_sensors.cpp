#include "diagnosis/identification/noise_of_sensors.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/assert.hpp"
#include "diagnosis/identification/discrepancy.hpp"
#include "diagnosis/identification/problem.hpp"
#include "diagnosis/identification/segment.hpp"
#include "diagnosis/signals/noise_parts.hpp"
#include "diagnosis/signals/signals.hpp"

namespace hybridtest {
namespace {

/// The segment that ends at a channel, if the model predicts it.
std::optional<Segment> segment_to(Channel channel, const SiteModel& model, const Recording& recording,
                                  std::size_t dof) {
  for (Segment& segment : segments_of(recording, dof, 0)) {
    if (segment.to == channel && !segment.is_quasi_static && is_modelled(model, segment)) return std::move(segment);
  }
  return {};
}

/// What the model leaves and no function of the motion explains; empty where the motion explains half of it or more.
std::vector<double> remainder_of(const SiteModel& model, Segment segment) {
  std::vector<double> left = predict(model, segment);
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = segment.measured[i] - left[i];
  std::vector<Segment> segments;
  segments.push_back(std::move(segment));
  const IdentificationProblem problem = make_problem(model, std::move(segments));
  const FitSegment& fit = problem.segments.front();
  const Eigen::VectorXd residual = fit.average(left);
  const ResidualParts parts = fit.discrepancy->parts(residual);
  if (parts.repeatable >= parts.total - parts.repeatable) return {};
  left.resize(static_cast<std::size_t>(residual.size()) * fit.averaged);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i / fit.averaged);
    left[i] -= residual[at] - parts.remainder[at];
  }
  return left;
}

NoiseParts noise_of(Channel channel, const SiteModel& model, const Recording& recording, std::size_t dof) {
  const double white = typical_white_noise(recording.dofs[dof].of(channel));
  const std::optional<Segment> of_motion = segment_to(Channel::measured_displacement, model, recording, dof);
  if (!of_motion) return {.white = white};
  std::vector<double> left;
  if (channel == Channel::measured_displacement) {
    left = remainder_of(model, *of_motion);
  } else {
    Recording without_noise = recording;
    without_noise.dofs[dof].of(Channel::measured_displacement) = predict(model, *of_motion);
    std::optional<Segment> of_force = segment_to(channel, model, without_noise, dof);
    if (of_force) left = remainder_of(model, *std::move(of_force));
  }
  NoiseParts parts = noise_parts(left, recording.sample_period_s);
  parts.white = parts.coloured > 0.0 ? std::min(parts.white, white) : white;
  return parts;
}

/// Sums over the degrees of freedom.
struct SumsOverDofs {
  double white = 0.0;
  double coloured = 0.0;
  double coloured_by_time = 0.0;  // so much of it is at low frequencies
};

SumsOverDofs sums_over_dofs(Channel channel, std::span<const SiteModel> completed, const Recording& recording) {
  SumsOverDofs sum;
  for (std::size_t dof = 0; dof < recording.dofs.size(); ++dof) {
    if (!recording.dofs[dof].has(channel)) continue;
    const NoiseParts parts = noise_of(channel, completed[dof], recording, dof);
    sum.white += parts.white * parts.white;
    sum.coloured += parts.coloured * parts.coloured;
    sum.coloured_by_time += parts.coloured * parts.coloured * parts.correlation_time_s;
  }
  return sum;
}

}  // namespace

SensorNoise noise_of_sensors(std::span<const SiteModel> completed, const Recording& recording) {
  HYBRIDTEST_ASSERT(completed.size() == recording.dofs.size());
  const auto dofs = static_cast<double>(recording.dofs.size());
  const SumsOverDofs displacement = sums_over_dofs(Channel::measured_displacement, completed, recording);
  const SumsOverDofs force = sums_over_dofs(Channel::measured_force, completed, recording);
  SensorNoise noise{.displacement_noise_m = std::sqrt(displacement.white / dofs),
                    .force_noise_n = std::sqrt(force.white / dofs)};
  if (displacement.coloured > 0.0) {
    noise.displacement_coloured_noise_m = std::sqrt(displacement.coloured / dofs);
    noise.displacement_correlation_time_s = displacement.coloured_by_time / displacement.coloured;
  }
  if (force.coloured > 0.0) {
    noise.force_coloured_noise_n = std::sqrt(force.coloured / dofs);
    noise.force_correlation_time_s = force.coloured_by_time / force.coloured;
  }
  return noise;
}

}  // namespace hybridtest
