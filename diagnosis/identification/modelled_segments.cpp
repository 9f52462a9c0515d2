#include "diagnosis/identification/modelled_segments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hybridtest {
namespace {

/// Of inertia and damping, and of nothing else that a model has beside its law.
bool follows_derivatives(const SiteModel& model) {
  return std::ranges::any_of(model.effects, [](const EffectSetting& effect) {
    return effect.type->interface == EffectInterface::specimen && effect.type->traits.follows_derivatives;
  });
}

Segment best_smoothed(const SiteModel& model, const Segment& segment, const DofRecording& dof) {
  constexpr std::array kDeviations{0.0, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 11.0, 16.0, 23.0, 32.0};  // samples
  double best = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (const double deviation : kDeviations) {
    const Segment tried = smoothed_alike(segment, dof, deviation);
    const std::vector<double> predicted = predict(model, tried);
    double squares = 0.0;
    for (std::size_t i = 0; i < predicted.size(); ++i) squares += std::pow(segment.measured[i] - predicted[i], 2);
    if (squares < least) {
      least = squares;
      best = deviation;
    }
  }
  // There, what is taken off the motion is as much as the noise that is left. As the force is smoothed too, it is
  // not missed, and the next step is quieter.
  constexpr double kNextStep = 1.4;
  return smoothed_alike(segment, dof, kNextStep * best);
}

}  // namespace

std::vector<Segment> modelled_segments(const SiteModel& model, const Recording& recording, std::size_t dof,
                                       std::size_t position) {
  std::vector<Segment> segments;
  for (Segment& segment : segments_of(recording, dof, position)) {
    if (!is_modelled(model, segment)) continue;
    const bool is_smoothed = segment.to == Channel::measured_force && follows_derivatives(model);
    segments.push_back(is_smoothed ? best_smoothed(model, segment, recording.dofs[dof]) : std::move(segment));
  }
  return segments;
}

}  // namespace hybridtest
