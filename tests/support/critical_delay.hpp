#pragma once

#include <cstddef>
#include <vector>

#include "coordinator/preflight/coupled_loop.hpp"
#include "coordinator/preflight/site_coupling.hpp"
#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// The reference of the preflight's figures, found by another method and without a step. Critical delay: the pure delay
/// of the force of one site at which the coupled linear test becomes unstable.
///
/// The equation of motion with the force of site s delayed by tau has the characteristic equation
///
///   det[ A(l) + e^{-l tau} B^T S(l) B ] = 0,
///   A = l^2 M + l C + K - B^T K_e B + (other sites, undelayed),   S = l^2 M_e + l C_e + K_e.
///
/// By Sylvester's identity it has a root i w exactly when an eigenvalue mu of the loop transfer
/// matrix S(iw) B A(iw)^-1 B^T satisfies 1 + e^{-iw tau} mu = 0. So |mu(w)| = 1 gives the
/// crossing frequencies and w tau = arg(-mu), in [0, 2 pi), the delay of each; roots move
/// continuously with tau, so the smallest delay of all crossings is where stability is lost
/// (Mercan and Ricles, 2007; Gu, Kharitonov and Chen, Stability of Time-Delay Systems, 2003,
/// section 2.3). Crossings are bracketed by a frequency sweep that is dense around the natural
/// frequencies of the undelayed part, extremes between samples are searched, and each is bisected
/// to machine precision.
///
/// @param structure   M and C as integrated by the coordinator, without the specimens' own mass and
///                    damping; initial stiffness of everything, the sites' included.
/// @param sites       all experimental sites; the force of site `late` is delayed.
/// @throws ConfigError as require_consistent() of structure and sites.
[[nodiscard]] CriticalDelay critical_delay(const LinearStructure& structure, const std::vector<CoupledSite>& sites,
                                           std::size_t late);

}  // namespace hybridtest
