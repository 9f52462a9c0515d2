#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/answer_memory.hpp"
#include "core/membership.hpp"
#include "core/messages.hpp"
#include "core/node.hpp"
#include "core/ports.hpp"
#include "core/presence.hpp"
#include "core/records.hpp"
#include "numerical_substructure/substructure_model.hpp"

namespace hybridtest {

/// Answers each displacement command with the restoring force of a structural model. A step changes
/// the model once, also when its command arrives several times. A trial does not change it: the next trial of the step,
/// or its final command, starts from the state at the end of the step before.
///
/// A model that computes outside this process may take seconds: the node shows its presence meanwhile. One that fails
/// ends the test, with its reason.
///
/// A coordinator that was resumed from its recording may command steps again that were taken. They are answered from
/// memory; where it commands another displacement than was taken, the node ends the test.
class NumericalNode final : public Node {
 public:
  /// @param index      position of this substructure in the scenario.
  /// @param recorded   positions of interface degrees of freedom, for the rows of `steps`.
  /// @param remembered   answers that are kept for a coordinator that is resumed.
  NumericalNode(SubstructureIndex index, CouplingMode mode, std::unique_ptr<SubstructureModel> model,
                Presence& presence, MembershipPorts membership, Inbox<DisplacementCommand>& commands,
                Outbox<ForceMeasurement>& measurements, RowSink& steps, std::vector<Eigen::Index> recorded,
                std::size_t remembered = 0);

  [[nodiscard]] Instant advance(Instant now) noexcept override;

  /// How a step of a recording that is taken again came out.
  enum class Restored : std::uint8_t {
    same,         // the recorded force, bit for bit
    different,    // another force
    not_at_once,  // the model computes outside this process: it has no state to restore here
  };
  /// Takes a recorded step again, before the first advance().
  [[nodiscard]] Restored restore(const CommandPoint& point, std::uint16_t iteration,
                                 const InterfaceVector& recorded_force_n) noexcept;

  /// Leaves the test, as Ctrl-C does, at the next advance().
  void request_stop(StopReason reason) noexcept {
    if (!is_done()) requested_stop_ = reason;
  }

  [[nodiscard]] bool is_done() const noexcept;
  [[nodiscard]] StopReason stop_reason() const noexcept {
    return requested_stop_ != StopReason::none ? requested_stop_ : membership_.stop_reason();
  }

  /// What the model wrote before it failed; empty where it did not.
  [[nodiscard]] std::string failure_text() const { return model_->failure_text(); }

  /// @param dofs   names of the recorded interface degrees of freedom.
  [[nodiscard]] static TableLayout steps_layout(const std::vector<std::string>& dofs);

 private:
  void obey(Request request) noexcept;
  void serve(const DisplacementCommand& command, Instant now) noexcept;
  /// A step that was taken, for a resumed coordinator.
  void answer_again(const DisplacementCommand& command, Instant now) noexcept;
  /// Ends the test: the resumed coordinator asks for what cannot be.
  void refuse(Recall recall, const CommandPoint& point, Instant now) noexcept;
  /// Takes the answer that the model owes, and goes on with its command.
  void await_model(Instant now) noexcept;
  /// The step at the point, or a trial of it: force at the displacement, from the state at the end of the last step.
  /// @return whether the force is there.
  bool compute(const CommandPoint& point, bool is_trial, Instant now) noexcept;
  /// The force of the point that the model computes is there, or is not.
  bool conclude(ModelAnswer answer, Instant now) noexcept;
  void record_step(const CommandPoint& point) noexcept;
  /// The force at the newest point of the command.
  void answer_newest(Instant now) noexcept;
  void answer(const DisplacementCommand& command, Instant now, MeasurementFlags flags) noexcept;
  void send_answer(const DisplacementCommand& command, Instant now, MeasurementFlags flags) noexcept;

  SubstructureIndex index_;
  CouplingMode mode_;
  std::unique_ptr<SubstructureModel> model_;
  Presence& presence_;
  Membership membership_;
  Inbox<DisplacementCommand>& commands_;
  Outbox<ForceMeasurement>& measurements_;
  RowSink& steps_;
  StopReason requested_stop_ = StopReason::none;
  CommandPoint last_point_;  // the last one answered
  std::uint16_t last_iteration_ = 0;
  Step last_step_ = kNoStep;  // the last one whose state the model has
  bool is_tried_ = false;     // the model holds a trial
  CommandPoint computed_;     // with the model
  bool is_trial_ = false;     // likewise
  bool is_pending_ = false;   // the model owes its force
  bool has_failed_ = false;   // the model answers no more
  bool is_restored_ = false;  // the model has the state of a recording
  AnswerMemory memory_;
  DisplacementCommand command_;  // the ones being taken and sent; kept, so that their memory is used again
  ForceMeasurement answer_;
  InterfaceVector force_n_;
  std::vector<Eigen::Index> recorded_;
  std::vector<double> row_;
};

}  // namespace hybridtest
