#include "numerical_substructure/opensees/opensees_model.hpp"

#include <algorithm>
#include <exception>
#include <limits>
#include <utility>

#include "core/assert.hpp"
#include "core/config_error.hpp"
#include "numerical_substructure/opensees/opensees_child.hpp"

namespace hybridtest {
namespace {

OpenSeesModel::OpenChannel opensees_channel(const OpenSeesSettings& settings) {
  return [settings](const ModelSurroundings& surroundings) {
    return std::make_unique<OpenSeesChild>(settings, OpenSeesPurpose::test, surroundings.log, surroundings.wake);
  };
}

}  // namespace

double displacement_unit(const OpenSeesSettings& settings, std::size_t dof) noexcept {
  return settings.interface[dof].is_rotation ? 1.0 : settings.length_unit_m;
}

double force_unit(const OpenSeesSettings& settings, std::size_t dof) noexcept {
  return settings.interface[dof].is_rotation ? settings.force_unit_n * settings.length_unit_m : settings.force_unit_n;
}

void require_ready(DriverChannel& channel, const OpenSeesSettings& settings) {
  const std::string where = settings.script.string() + ": ";
  DriverReply reply;
  switch (channel.take(reply, settings.answer_timeout)) {
    case DriverArrival::reply: break;
    case DriverArrival::none:
      throw ConfigError{where + "OpenSees has not read the model within " +
                        std::to_string(to_seconds(settings.answer_timeout)) +
                        " s; a larger model needs a larger answer_timeout_s" + channel.last_words()};
    case DriverArrival::ended:
      throw ConfigError{where + "OpenSees ended with exit code " + std::to_string(channel.exit_code()) +
                        " while it read the model" + channel.last_words()};
  }
  if (reply.kind != DriverReply::Kind::ready) throw ConfigError{where + reply.text + channel.last_words()};
}

OpenSeesModel::OpenSeesModel(OpenSeesSettings settings) : OpenSeesModel{settings, opensees_channel(settings)} {}

OpenSeesModel::OpenSeesModel(OpenSeesSettings settings, OpenChannel open)
    : settings_{std::move(settings)}, open_{std::move(open)}, displacements_(settings_.interface.size()) {}

void OpenSeesModel::start(const ModelSurroundings& surroundings) {
  surroundings_ = surroundings;
  open();
}

void OpenSeesModel::open() {
  channel_.reset();  // files of recorders are closed before the next process opens them
  channel_ = open_(surroundings_);
  require_ready(*channel_, settings_);
  has_history_ = false;
}

void OpenSeesModel::reset() noexcept {
  if (!has_history_) return;
  try {
    open();
  } catch (const std::exception& error) {
    reply_.text = error.what();
    failure_ = {ModelFault::script, 0.0};
    has_failed_ = true;
  }
}

InterfaceMatrix OpenSeesModel::initial_stiffness_n_per_m() const {
  if (settings_.initial_stiffness_n_per_m) return *settings_.initial_stiffness_n_per_m;
  return opensees_stiffness_n_per_m(settings_);
}

void OpenSeesModel::trial(const InterfaceVector& displacement_m, const InterfaceVector& /*velocity_m_per_s*/,
                          InterfaceVector& force_n) noexcept {
  tried_m_ = displacement_m;
  if (begin(DriverRequest::trial, displacement_m, force_n, Instant{}) == ModelAnswer::pending) {
    static_cast<void>(take(force_n, settings_.answer_timeout));
  }
}

void OpenSeesModel::commit() noexcept {
  InterfaceVector force_n = InterfaceVector::Zero(interface_dofs());
  if (begin(DriverRequest::step, tried_m_, force_n, Instant{}) == ModelAnswer::pending) {
    static_cast<void>(take(force_n, settings_.answer_timeout));
  }
}

ModelAnswer OpenSeesModel::begin_trial(const InterfaceVector& displacement_m, const InterfaceVector& /*velocity*/,
                                       InterfaceVector& force_n, Instant now) noexcept {
  return begin(DriverRequest::trial, displacement_m, force_n, now);
}

ModelAnswer OpenSeesModel::begin_step(const InterfaceVector& displacement_m, const InterfaceVector& /*velocity*/,
                                      InterfaceVector& force_n, Instant now) noexcept {
  return begin(DriverRequest::step, displacement_m, force_n, now);
}

ModelAnswer OpenSeesModel::begin(DriverRequest request, const InterfaceVector& displacement_m, InterfaceVector& force_n,
                                 Instant now) noexcept {
  HYBRIDTEST_ASSERT(channel_ != nullptr || has_failed_);
  HYBRIDTEST_ASSERT(displacement_m.size() == interface_dofs());
  if (has_failed_) return fail(failure_, force_n);
  for (std::size_t k = 0; k < displacements_.size(); ++k) {
    displacements_[k] = displacement_m[static_cast<Eigen::Index>(k)] / displacement_unit(settings_, k);
  }
  has_history_ = has_history_ || request == DriverRequest::step;
  overdue_ = now + settings_.answer_timeout;
  if (!channel_->send(request, displacements_)) {
    return fail({ModelFault::ended, static_cast<double>(channel_->exit_code())}, force_n);
  }
  if (surroundings_.wake) return ModelAnswer::pending;
  return take(force_n, settings_.answer_timeout);
}

ModelAnswer OpenSeesModel::take_answer(InterfaceVector& force_n, Instant now) noexcept {
  const ModelAnswer answer = take(force_n, Duration{});
  if (answer != ModelAnswer::pending || now < overdue_) return answer;
  return fail({ModelFault::silent, to_seconds(settings_.answer_timeout)}, force_n);
}

ModelAnswer OpenSeesModel::take(InterfaceVector& force_n, Duration limit) noexcept {
  switch (channel_->take(reply_, limit)) {
    case DriverArrival::reply: break;
    case DriverArrival::none:
      if (limit == Duration{}) return ModelAnswer::pending;
      return fail({ModelFault::silent, to_seconds(limit)}, force_n);
    case DriverArrival::ended: return fail({ModelFault::ended, static_cast<double>(channel_->exit_code())}, force_n);
  }
  if (reply_.kind == DriverReply::Kind::not_converged) {
    return fail({ModelFault::not_converged, reply_.residual}, force_n);
  }
  if (reply_.kind != DriverReply::Kind::forces) return fail({ModelFault::script, 0.0}, force_n);
  for (std::size_t k = 0; k < reply_.forces.size(); ++k) {
    force_n[static_cast<Eigen::Index>(k)] = reply_.forces[k] * force_unit(settings_, k);
  }
  return ModelAnswer::ready;
}

ModelAnswer OpenSeesModel::fail(ModelFailure failure, InterfaceVector& force_n) noexcept {
  failure_ = failure;
  has_failed_ = true;
  force_n.setConstant(std::numeric_limits<double>::quiet_NaN());
  return ModelAnswer::failed;
}

std::string OpenSeesModel::failure_text() const {
  if (!has_failed_) return "";
  std::string text = settings_.script.string() + ": " + describe(failure_);
  if (failure_.fault == ModelFault::script) text += ": " + reply_.text;
  return channel_ == nullptr ? text : text + channel_->last_words();
}

}  // namespace hybridtest
