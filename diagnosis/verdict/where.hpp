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

/// What each interface has of the gap: the energy of its residual above its floor, relative to the
/// energy of its output; shares add up to one.
///
/// A gap that a chosen sensor effect explains is the sensor's, not that of the stage it is seen in, which is listed
/// with what is left there.
/// @param chosen   fit of the causes; equal to `baseline` when there is none.
/// @param seed     of the block bootstrap behind the intervals.
[[nodiscard]] std::vector<report::InterfaceGap> locate(const IdentificationProblem& problem, const FitOutcome& baseline,
                                                       const FitOutcome& chosen, std::uint64_t seed);

/// An entry, with what is missing, for every interface of the chain that `where` does not have.
/// @param dof   0-based; of recordings of the role fit.
void add_unjudged(const SiteModel& model, std::span<const Recording> recordings, std::size_t dof,
                  std::vector<report::InterfaceGap>& where);

/// How closely the residual of each judged interface comes back, where the test repeats itself: recordings with the
/// same input, else cycles (floor_of_repetition(), floor_of_cycles()); the largest of an interface. It holds what noise
/// alone does not: what the specimen and the actuator do differently from one time to the next.
void add_repeatability(const SiteModel& model, std::span<const Segment> segments,
                       std::vector<report::InterfaceGap>& where);

}  // namespace hybridtest
