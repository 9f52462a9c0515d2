#pragma once

#include <span>
#include <string>
#include <vector>

#include "diagnosis/recording.hpp"

namespace hybridtest {

/// The recordings with the hum of the mains taken off the measured displacement where the force does not follow it: it
/// is the reading's, and not the specimen's. Left in, a replay would take it for motion: a damper's force of it is
/// large, and an effect that cancels it would be chosen for that.
///
/// The hum is one sine of 50 or 60 Hz within 1 %, fitted to the whole recording under a Hann window. It is there where
/// its line stands out of its neighbours by more than chance allows (F test of 2 and 32 degrees of freedom, at the rate
/// of false alarms over the lines that are tried), and the force does not follow it where its own line is less than
/// half of what a spring of the recording's secant stiffness would make of it. What is the reading's in one recording
/// is in all of them: the force has a hum of its own, which may be as large. Not asked: quasi-static recordings, those
/// without a force or longer than two minutes, over which the mains are no one sine, and readings of a coarse
/// converter, whose steps would be lost.
/// @param copy    holds them.
/// @param notes   what was taken off which recordings, in words.
/// @return        `recordings` itself where there is no hum.
[[nodiscard]] std::span<const Recording> without_mains_hum(std::span<const Recording> recordings, std::size_t dof,
                                                           std::vector<Recording>& copy,
                                                           std::vector<std::string>& notes);

}  // namespace hybridtest
