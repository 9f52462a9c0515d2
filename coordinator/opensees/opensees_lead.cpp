#include "coordinator/opensees/opensees_lead.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

[[nodiscard]] MotionState at_rest(Eigen::Index size) {
  return {Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size)};
}

}  // namespace

OpenSeesLead::OpenSeesLead(OpenSeesLeadSettings settings, ElementPort& port, RowSink& trials)
    : settings_{std::move(settings)},
      port_{port},
      trials_{trials},
      elements_(settings_.elements.size()),
      current_{at_rest(settings_.structure_size)},
      completed_{current_},
      structure_force_n_{Eigen::VectorXd::Zero(settings_.structure_size)} {
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const LedElement& led = settings_.elements[i];
    const auto size = std::ssize(led.dofs);
    elements_[i].trial = {Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size)};
    elements_[i].imposed = elements_[i].trial;
    elements_[i].force_n = Eigen::VectorXd::Zero(size);
  }
}

ParticipantId OpenSeesLead::awaited(Instant now) noexcept {
  take_requests(now);
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    if (!elements_[i].is_connected) return settings_.elements[i].id;
  }
  return {};
}

NextMotion OpenSeesLead::next(Instant now) noexcept {
  if (std::exchange(was_away_, false)) heard_ = now;
  take_requests(now);
  if (is_commanded_) return NextMotion::command;
  while (end_.reason == StopReason::none) {
    for (std::size_t i = 0; i < elements_.size(); ++i) go_on(i);
    if (end_.reason != StopReason::none) break;
    const bool is_commit = std::ranges::any_of(elements_, &Element::commits);
    const bool is_question = std::ranges::any_of(elements_, &Element::asks);
    if (!is_commit && !is_question) {
      wait_since_ = kNever;
      if (now - heard_ >= settings_.silence) {
        end_ = {StopReason::opensees_lost, {EventCode::opensees_silent, {}, {to_seconds(now - heard_), 0.0}}};
        break;
      }
      wake_ = heard_ + settings_.silence;
      return NextMotion::none;
    }
    if (!are_together(is_commit)) {
      if (wait_since_ == kNever) wait_since_ = now;
      wake_ = wait_since_ + kTogether;
      if (now < wake_) return NextMotion::none;
    }
    wait_since_ = kNever;
    if (is_commit && !is_uncommitted()) {
      finish_commit();
      continue;
    }
    if (!is_commit && iterates()) break;
    command_trials(!is_commit && settings_.can_revert);
    return NextMotion::command;
  }
  return NextMotion::end;
}

void OpenSeesLead::take_requests(Instant now) noexcept {
  while (port_.take(request_)) {
    heard_ = now;
    const auto index = static_cast<std::size_t>(request_.element);
    HYBRIDTEST_ASSERT(index < elements_.size());
    Element& element = elements_[index];
    const ParticipantId& id = settings_.elements[index].id;
    switch (request_.kind) {
      case ElementRequest::Kind::connected:
        element.is_connected = true;
        // Before the test a model may come and go; what an earlier one said does not count.
        if (is_commanded_ && step_ == 0) element.arrived.clear();
        break;
      case ElementRequest::Kind::refused:
        told_ = LeadEvent{EventCode::opensees_refused, id, {static_cast<double>(request_.fault), request_.given}};
        break;
      case ElementRequest::Kind::lost:
        element.is_connected = false;
        element.arrived.push_back(request_);
        break;
      case ElementRequest::Kind::trial:
      case ElementRequest::Kind::force:
      case ElementRequest::Kind::commit:
      case ElementRequest::Kind::die: element.arrived.push_back(request_); break;
    }
  }
}

void OpenSeesLead::go_on(std::size_t index) noexcept {
  Element& element = elements_[index];
  while (!element.commits && end_.reason == StopReason::none) {
    if (element.asks && is_imposed(element)) {
      port_.answer_force(static_cast<int>(index), element.force_n);
      element.asks = false;
    }
    if (element.asks || element.arrived.empty()) return;
    ElementRequest& request = element.arrived.front();
    switch (request.kind) {
      case ElementRequest::Kind::trial:
        ++element.trials;
        element.trial.displacement_m.swap(request.displacement_m);
        element.trial.velocity_m_per_s.swap(request.velocity_m_per_s);
        element.trial.acceleration_m_per_s2.swap(request.acceleration_m_per_s2);
        element.time_s = request.time_s;
        break;
      case ElementRequest::Kind::force: element.asks = true; break;
      case ElementRequest::Kind::commit:
        // The models go on from the state that OpenSees commits; a specimen is where it is.
        if (settings_.can_revert) {
          element.commits = true;
        } else {
          element.moves = 0;
        }
        break;
      case ElementRequest::Kind::die: end_.reason = StopReason::completed; break;
      case ElementRequest::Kind::lost:
        end_ = {StopReason::opensees_lost,
                {EventCode::opensees_lost,
                 settings_.elements[index].id,
                 {static_cast<double>(request.fault), request.given}}};
        break;
      case ElementRequest::Kind::connected:
      case ElementRequest::Kind::refused: break;  // dealt with on arrival
    }
    element.arrived.pop_front();
  }
}

bool OpenSeesLead::is_imposed(const Element& element) const noexcept {
  // What a model answers may depend on the velocity; a specimen has its own.
  return element.trial.displacement_m == element.imposed.displacement_m &&
         (!settings_.can_revert || element.trial.velocity_m_per_s == element.imposed.velocity_m_per_s);
}

bool OpenSeesLead::are_together(bool is_commit) const noexcept {
  return std::ranges::all_of(elements_, [&](const Element& element) {
    return element.trials == elements_.front().trials && (!is_commit || element.commits);
  });
}

bool OpenSeesLead::is_uncommitted() const noexcept {
  return is_tried_ || !std::ranges::all_of(elements_, [&](const Element& element) { return is_imposed(element); });
}

bool OpenSeesLead::iterates() noexcept {
  if (settings_.can_revert || settings_.allow_iterations) return false;
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    if (elements_[i].moves == 0 || is_imposed(elements_[i])) continue;
    end_ = {StopReason::opensees_iterates, {EventCode::opensees_iterates, settings_.elements[i].id, {}}};
    return true;
  }
  return false;
}

void OpenSeesLead::command_trials(bool is_trial) noexcept {
  double time_s = 0.0;
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    Element& element = elements_[i];
    if (!is_imposed(element)) ++element.moves;
    time_s = std::max(time_s, element.time_s);
    // Of a degree of freedom that two elements have, the new displacement counts.
    if (std::exchange(element.trials, 0) == 0) continue;
    for (Eigen::Index k = 0; k < element.trial.displacement_m.size(); ++k) {
      const Eigen::Index row = settings_.elements[i].dofs[static_cast<std::size_t>(k)];
      current_.displacement_m[row] = element.trial.displacement_m[k];
      current_.velocity_m_per_s[row] = element.trial.velocity_m_per_s[k];
      current_.acceleration_m_per_s2[row] = element.trial.acceleration_m_per_s2[k];
    }
  }
  is_trial_ = is_trial;
  is_commanded_ = true;
  trials_.append(std::array{static_cast<double>(step_), static_cast<double>(iteration_), is_trial ? 1.0 : 0.0, time_s});
}

void OpenSeesLead::take_force(SubstructureIndex substructure, const InterfaceVector& force_n) noexcept {
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const LedElement& led = settings_.elements[i];
    if (led.substructure != substructure) continue;
    structure_force_n_.setZero();
    led.interface.add_to_structure(force_n, structure_force_n_);
    for (std::size_t k = 0; k < led.dofs.size(); ++k) {
      elements_[i].force_n[static_cast<Eigen::Index>(k)] = structure_force_n_[led.dofs[k]];
    }
  }
}

void OpenSeesLead::advance(const Eigen::Ref<const Eigen::VectorXd>&,
                           const Eigen::Ref<const Eigen::VectorXd>&) noexcept {
  for (Element& element : elements_) element.imposed = element.trial;
  is_commanded_ = false;
  was_away_ = true;
  is_tried_ = is_trial_;
  if (is_trial_) {
    ++iteration_;
    return;
  }
  completed_ = current_;
  iteration_ = 0;
  ++step_;
  finish_commit();
}

void OpenSeesLead::finish_commit() noexcept {
  for (Element& element : elements_) {
    if (std::exchange(element.commits, false)) element.moves = 0;
  }
}

std::optional<LeadEvent> OpenSeesLead::take_event() noexcept { return std::exchange(told_, std::nullopt); }

TableLayout OpenSeesLead::trials_layout() {
  return {"opensees", {{"step", ""}, {"iteration", ""}, {"is_trial", ""}, {"opensees_time_s", "s"}}};
}

}  // namespace hybridtest
