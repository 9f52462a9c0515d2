#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/segment.hpp"
#include "diagnosis/recording.hpp"
#include "diagnosis/result/diagnosis_report.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// The share of each interface in the gap: the energy of its residual above its floor, relative to the
/// energy of its output; shares add up to one.
///
/// A gap that a chosen sensor effect explains counts for the sensor, not for the stage in which it is visible; the
/// stage is listed with the remaining gap.
/// @param chosen   fit of the causes; equal to `baseline` when there is none.
/// @param seed     of the block bootstrap for the intervals.
[[nodiscard]] std::vector<report::InterfaceGap> locate(const IdentificationProblem& problem, const FitOutcome& baseline,
                                                       const FitOutcome& chosen, std::uint64_t seed);

/// Adds an entry with the reason for every interface of the chain that is not in `where`.
/// @param dof   0-based; of recordings of the role fit.
void add_unjudged(const SiteModel& model, std::span<const Recording> recordings, std::size_t dof,
                  std::vector<report::InterfaceGap>& where);

/// The difference between repetitions of the residual of each judged interface: from recordings with the same input,
/// else from cycles (floor_of_repetition(), floor_of_cycles()); the largest of an interface. Besides noise it contains
/// the variation of specimen and actuator between repetitions.
void add_repeatability(const SiteModel& model, std::span<const Segment> segments,
                       std::vector<report::InterfaceGap>& where);

/// Whether that difference is one between recordings.
[[nodiscard]] bool was_recorded_again(const report::InterfaceGap& gap);

}  // namespace hybridtest
