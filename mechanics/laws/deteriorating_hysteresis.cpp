#include "mechanics/laws/deteriorating_hysteresis.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

DeterioratingHysteresis::DeterioratingHysteresis(const Parameters& parameters, const Form& form)
    : parameters_{checked(parameters)}, form_{form} {
  const double crack_n = form.cracking_force_n > 0.0 ? form.cracking_force_n : parameters.yield_force_n;
  crack_ = {crack_n / parameters.stiffness_n_per_m, crack_n};
  if (has_cap()) {
    const double descent_m = checked("post_capping_displacement_m", parameters.post_capping_displacement_m, kPositive,
                                     "capping_displacement_m is given");
    post_capping_n_per_m_ = -(parameters.yield_force_n + parameters.hardening_ratio * parameters.stiffness_n_per_m *
                                                             parameters.capping_displacement_m) /
                            descent_m;
  }
  reset();
}

DeterioratingHysteresis::State DeterioratingHysteresis::virgin() const noexcept {
  const double k = parameters_.stiffness_n_per_m;
  Side side;
  side.yield_force_n = parameters_.yield_force_n;
  side.hardening_n_per_m = parameters_.hardening_ratio * k;
  side.peak = side.turn = crack_;
  const double highest_n = parameters_.yield_force_n + side.hardening_n_per_m * parameters_.capping_displacement_m;
  side.capping_force_n = highest_n - post_capping_n_per_m_ * (yield_m(side) + parameters_.capping_displacement_m);
  State state;
  state.unloading_n_per_m = k;
  state.sides = {side, side};
  return state;
}

double DeterioratingHysteresis::trial(double displacement_m, double /*velocity_m_per_s*/) noexcept {
  trial_ = committed_;
  if (std::isnan(displacement_m)) return displacement_m;
  if (!trial_.is_lost) advance(trial_, displacement_m);
  if (trial_.is_lost) {
    trial_.displacement_m = displacement_m;
    trial_.force_n = 0.0;
  }
  return trial_.force_n;
}

void DeterioratingHysteresis::advance(State& state, double displacement_m) const noexcept {
  if (state.is_virgin) {
    const double elastic_m = std::clamp(displacement_m, -crack_.displacement_m, crack_.displacement_m);
    state.side = displacement_m < 0.0 ? -1.0 : 1.0;
    state.displacement_m = elastic_m;
    state.force_n = parameters_.stiffness_n_per_m * elastic_m;
    state.energy_j = 0.5 * state.force_n * elastic_m;
    if (elastic_m == displacement_m) return;
    state.is_virgin = false;
    state.corners[0] = {};
    state.corners[1] = crack_;
    state.corner_count = 2;
    add_backbone(state);
  }
  if (!state.is_unloading && state.side * (displacement_m - state.displacement_m) < 0.0) begin_unloading(state);
  if (state.is_unloading) {
    const Point turn = side_of(state).turn;
    const double on_side_m = state.side * displacement_m;
    const double zero_m = turn.displacement_m - turn.force_n / state.unloading_n_per_m;
    if (on_side_m < zero_m) {
      move(state, {zero_m, 0.0});
      state.side = -state.side;
      begin_excursion(state);
    } else if (on_side_m < turn.displacement_m) {
      const double elastic_n = state.unloading_n_per_m * (turn.displacement_m - on_side_m);
      move(state, {on_side_m, turn.force_n - elastic_n});
    } else {
      move(state, turn);
      state.is_unloading = false;
    }
  }
  if (!state.is_unloading) follow_corners(state, state.side * displacement_m);
}

/// Straight to a point on the present side.
void DeterioratingHysteresis::move(State& state, const Point& to) noexcept {
  const double displacement_m = state.side * to.displacement_m;
  const double force_n = state.side * to.force_n;
  state.energy_j += 0.5 * (state.force_n + force_n) * (displacement_m - state.displacement_m);
  state.displacement_m = displacement_m;
  state.force_n = force_n;
}

void DeterioratingHysteresis::follow_corners(State& state, double towards_m) const noexcept {
  for (std::size_t i = 1; i < state.corner_count; ++i) {
    const Point& from = state.corners[i - 1];
    const Point& to = state.corners[i];
    if (to.displacement_m < state.side * state.displacement_m) continue;
    if (towards_m < to.displacement_m) {
      const double share = (towards_m - from.displacement_m) / (to.displacement_m - from.displacement_m);
      move(state, {towards_m, from.force_n + share * (to.force_n - from.force_n)});
      return;
    }
    move(state, to);
    // The only corner without force is that of a residual strength of zero.
    if (to.force_n <= 0.0) state.is_lost = true;
  }
  const Point& last = state.corners[state.corner_count - 1];
  move(state, {towards_m, last.force_n + state.last_slope_n_per_m * (towards_m - last.displacement_m)});
}

void DeterioratingHysteresis::begin_unloading(State& state) const noexcept {
  Side& side = side_of(state);
  side.turn = {state.side * state.displacement_m, state.side * state.force_n};
  side.turn_is_inner = side.turn.displacement_m < side.peak.displacement_m;
  if (!side.turn_is_inner) side.peak = side.turn;
  state.is_unloading = true;
  const double stiffness_n_per_m = form_stiffness_n_per_m(side);
  const double stored_j = 0.5 * state.force_n * state.force_n / (stiffness_n_per_m * state.unloading_share_at_begin);
  const double dissipated_j = state.energy_j - stored_j;
  const double lost =
      beta(state, parameters_.unloading_capacity_m, dissipated_j, dissipated_j - state.energy_at_begin_j);
  state.unloading_share = state.unloading_share_at_begin * (1.0 - lost);
  state.unloading_n_per_m = stiffness_n_per_m * state.unloading_share;
}

/// At zero force, with the side that the motion is heading for.
void DeterioratingHysteresis::begin_excursion(State& state) const noexcept {
  state.is_unloading = false;
  deteriorate(state);
  state.energy_at_begin_j = state.energy_j;
  state.unloading_share_at_begin = state.unloading_share;
  aim_at_peak(state);
  add_backbone(state);
}

void DeterioratingHysteresis::deteriorate(State& state) const noexcept {
  Side& side = side_of(state);
  const double excursion_j = state.energy_j - state.energy_at_begin_j;
  const double strength = beta(state, parameters_.strength_capacity_m, state.energy_j, excursion_j);
  const double capping = beta(state, parameters_.capping_capacity_m, state.energy_j, excursion_j);
  const double reloading = beta(state, parameters_.reloading_capacity_m, state.energy_j, excursion_j);
  if (strength > 0.0) {
    side.yield_force_n = std::max(side.yield_force_n * (1.0 - strength), residual_n());
    side.hardening_n_per_m *= 1.0 - strength;
  }
  side.capping_force_n *= 1.0 - capping;
  side.peak.displacement_m *= 1.0 + reloading;
  side.peak.force_n = backbone_n(side, side.peak.displacement_m);
  if (side.peak.force_n <= 0.0) state.is_lost = true;
}

/// Share that an excursion with `excursion_j` takes of what is left after `energy_j`.
double DeterioratingHysteresis::beta(State& state, double capacity_m, double energy_j,
                                     double excursion_j) const noexcept {
  if (capacity_m == 0.0 || excursion_j <= 0.0) return 0.0;
  const double left_j = capacity_m * parameters_.yield_force_n - energy_j;
  if (excursion_j < left_j) return std::pow(excursion_j / left_j, parameters_.deterioration_exponent);
  state.is_lost = true;
  return 1.0;
}

/// From zero force to the largest displacement of the side. Deterioration can put zero force close to it or beyond: no
/// way is stiffer than the first loading.
void DeterioratingHysteresis::aim_at_peak(State& state) const noexcept {
  Side& side = side_of(state);
  const double k = parameters_.stiffness_n_per_m;
  const auto is_too_stiff = [k](const Point& from, const Point& to) {
    return !(to.force_n - from.force_n <= k * (to.displacement_m - from.displacement_m));
  };
  const Point start{state.side * state.displacement_m, 0.0};
  if (is_too_stiff(start, side.peak)) {
    side.peak.displacement_m =
        start.displacement_m + hardening_n(side, start.displacement_m) / (k - side.hardening_n_per_m);
    side.peak.force_n = backbone_n(side, side.peak.displacement_m);
  }
  const Point& peak = side.peak;
  state.corners[0] = start;
  state.corner_count = 1;
  const auto slope = [](const Point& from, const Point& to) {
    return (to.force_n - from.force_n) / (to.displacement_m - from.displacement_m);
  };
  const double break_m =
      (1.0 - form_.break_displacement_ratio) * (peak.displacement_m - peak.force_n / state.unloading_n_per_m);
  const Point bend{break_m, form_.break_force_ratio * slope(start, peak) * (break_m - start.displacement_m)};
  if (form_.break_force_ratio < 1.0 && start.displacement_m < break_m && !is_too_stiff(bend, peak))
    state.corners[state.corner_count++] = bend;
  const Point& from = state.corners[state.corner_count - 1];
  const bool is_ahead = from.displacement_m < side.turn.displacement_m && from.force_n < side.turn.force_n;
  if (side.turn_is_inner && is_ahead && side.turn.force_n < peak.force_n && !is_too_stiff(from, side.turn) &&
      slope(from, side.turn) > slope(from, peak))
    state.corners[state.corner_count++] = side.turn;
  state.corners[state.corner_count++] = peak;
}

/// The corners of the backbone that lie ahead of the last one.
void DeterioratingHysteresis::add_backbone(State& state) const noexcept {
  const Side& side = side_of(state);
  const auto add = [&state](double displacement_m, double force_n) {
    if (displacement_m <= state.corners[state.corner_count - 1].displacement_m) return;
    state.corners[state.corner_count++] = {displacement_m, force_n};
  };
  add(yield_m(side), side.yield_force_n);
  state.last_slope_n_per_m = side.hardening_n_per_m;
  if (!has_cap()) return;
  const double at_zero_n = hardening_n(side, 0.0);
  const double highest_m = (side.capping_force_n - at_zero_n) / (side.hardening_n_per_m - post_capping_n_per_m_);
  add(highest_m, at_zero_n + side.hardening_n_per_m * highest_m);
  add((residual_n() - side.capping_force_n) / post_capping_n_per_m_, residual_n());
  state.last_slope_n_per_m = 0.0;
}

double DeterioratingHysteresis::backbone_n(const Side& side, double displacement_m) const noexcept {
  if (displacement_m <= yield_m(side)) {
    const double elastic_n = parameters_.stiffness_n_per_m * displacement_m;
    if (form_.cracking_force_n == 0.0) return elastic_n;
    return std::min(elastic_n, crack_.force_n + form_.cracked_n_per_m * (displacement_m - crack_.displacement_m));
  }
  const double hardening = hardening_n(side, displacement_m);
  if (!has_cap()) return hardening;
  return std::max(std::min(hardening, side.capping_force_n + post_capping_n_per_m_ * displacement_m), residual_n());
}

/// The line of the backbone after yielding, also where another one is below it.
double DeterioratingHysteresis::hardening_n(const Side& side, double displacement_m) const noexcept {
  return side.yield_force_n + side.hardening_n_per_m * (displacement_m - yield_m(side));
}

double DeterioratingHysteresis::yield_m(const Side& side) const noexcept {
  if (form_.cracking_force_n == 0.0) return side.yield_force_n / parameters_.stiffness_n_per_m;
  return crack_.displacement_m + (side.yield_force_n - crack_.force_n) / form_.cracked_n_per_m;
}

/// Unloading stiffness before any deterioration: towards the cracking point of the other side up to yielding, and from
/// there on falling with the largest displacement.
double DeterioratingHysteresis::form_stiffness_n_per_m(const Side& side) const noexcept {
  if (form_.unloading_exponent == 0.0 && form_.cracking_force_n == 0.0) return parameters_.stiffness_n_per_m;
  const double yield_m_now = yield_m(side);
  const Point aim = side.peak.displacement_m < yield_m_now ? side.peak : Point{yield_m_now, side.yield_force_n};
  const double stiffness_n_per_m = (aim.force_n + crack_.force_n) / (aim.displacement_m + crack_.displacement_m);
  return stiffness_n_per_m * std::pow(aim.displacement_m / side.peak.displacement_m, form_.unloading_exponent);
}

}  // namespace hybridtest
