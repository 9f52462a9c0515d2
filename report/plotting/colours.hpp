#pragma once

#include <array>
#include <string_view>

namespace hybridtest::plot {

/// What a curve shows. A signal has the same colour on every page; other curves take the colours that are left.
enum class Signal { other, target, measured, modelled, completed, limit, ground_motion };

/// Colours that colour-blind people can distinguish (Okabe and Ito).
inline constexpr std::string_view kTargetColour = "#0072b2";     // target and command
inline constexpr std::string_view kMeasuredColour = "#d55e00";   // by sensors
inline constexpr std::string_view kModelledColour = "#009e73";   // predicted by a model
inline constexpr std::string_view kCompletedColour = "#cc79a7";  // by a model with the causes that a diagnosis found
inline constexpr std::string_view kLimitColour = "#222";         // dashed
inline constexpr std::string_view kGroundMotionColour = "#777";

/// For all other curves and marks, in this order.
inline constexpr std::array<std::string_view, 6> kOtherColours{"#e69f00", "#56b4e9", "#882255",
                                                               "#332288", "#999933", "#795548"};

/// Empty for Signal::other.
[[nodiscard]] constexpr std::string_view colour_of(Signal signal) noexcept {
  switch (signal) {
    case Signal::target: return kTargetColour;
    case Signal::measured: return kMeasuredColour;
    case Signal::modelled: return kModelledColour;
    case Signal::completed: return kCompletedColour;
    case Signal::limit: return kLimitColour;
    case Signal::ground_motion: return kGroundMotionColour;
    case Signal::other: break;
  }
  return {};
}

}  // namespace hybridtest::plot
