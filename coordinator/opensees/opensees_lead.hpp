#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "coordinator/motion_source.hpp"
#include "coordinator/opensees/element_port.hpp"
#include "core/records.hpp"
#include "core/time.hpp"
#include "mechanics/structure/interface_map.hpp"

namespace hybridtest {

/// A `genericClient` element of the model in OpenSees, and the substructure that stands for it.
struct LedElement {
  SubstructureIndex substructure = 0;
  ParticipantId id;                // of the substructure
  std::vector<Eigen::Index> dofs;  // rows of the structure, in the order in which the element lists them
  InterfaceMap interface;          // of the substructure
};

struct OpenSeesLeadSettings {
  Eigen::Index structure_size = 0;
  std::vector<LedElement> elements;
  /// No substructure is a specimen. Then each displacement is a trial, and the commit of OpenSees ends the step.
  bool can_revert = false;
  /// Several displacements in a step may be imposed on a specimen, each for good.
  bool allow_iterations = false;
  /// Longest time without a question.
  Duration silence = std::chrono::seconds{60};
};

/// An OpenSees that leads: its analysis says which displacement comes next, its `genericClient` elements ask for the
/// forces.
///
/// Step 0 is the structure at rest. A displacement becomes a command when the force of an element is asked for (10), of
/// all elements at once, and never by a trial (3) alone; a displacement that was imposed already is answered from what
/// was measured there. With a specimen each command ends a step of the test. With models alone each command is a trial,
/// and the commit (5) ends the step at the last trial displacement, which OpenSees commits itself, although its force
/// was perhaps not asked for. The order of the questions does not matter.
///
/// OpenSees updates its elements one after the other, over a connection each. What a command imposes is taken once all
/// elements have the same number of trials; where they do not within kTogether, what has arrived counts.
class OpenSeesLead final : public MotionSource {
 public:
  /// Wait for the trials of the other elements.
  static constexpr Duration kTogether = std::chrono::milliseconds{50};

  /// @param port   the elements, in the same order; must outlive the source.
  OpenSeesLead(OpenSeesLeadSettings settings, ElementPort& port, RowSink& trials);

  [[nodiscard]] const MotionState& current() const noexcept override { return current_; }
  [[nodiscard]] const MotionState& completed() const noexcept override { return completed_; }
  [[nodiscard]] int iteration() const noexcept override { return iteration_; }
  [[nodiscard]] bool is_trial() const noexcept override { return is_trial_; }
  void advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
               const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept override;

  [[nodiscard]] ParticipantId awaited(Instant now) noexcept override;
  [[nodiscard]] NextMotion next(Instant now) noexcept override;
  [[nodiscard]] Instant wake() const noexcept override { return wake_; }
  [[nodiscard]] LeadEnd end() const noexcept override { return end_; }
  void take_force(SubstructureIndex substructure, const InterfaceVector& force_n) noexcept override;
  [[nodiscard]] std::optional<LeadEvent> take_event() noexcept override;

  /// One row for each command.
  [[nodiscard]] static TableLayout trials_layout();

 private:
  struct Motion {
    Eigen::VectorXd displacement_m;
    Eigen::VectorXd velocity_m_per_s;
    Eigen::VectorXd acceleration_m_per_s2;
    bool operator==(const Motion&) const = default;
  };

  struct Element {
    std::deque<ElementRequest> arrived;  // not dealt with yet
    bool is_connected = false;
    bool asks = false;        // for the force
    bool commits = false;     // and waits for the others
    std::int64_t trials = 0;  // since the last command
    Motion trial;
    Motion imposed;           // whose force is known
    double time_s = 0.0;      // of the trial, in OpenSees
    Eigen::VectorXd force_n;  // at `imposed`
    int moves = 0;            // commands with a change of this element since the last commit
  };

  void take_requests(Instant now) noexcept;
  /// Deals with what arrived at an element, until it waits for an answer or for the commit of the others.
  void go_on(std::size_t index) noexcept;
  /// The force at the trial of the element is known.
  [[nodiscard]] bool is_imposed(const Element& element) const noexcept;
  [[nodiscard]] bool are_together(bool is_commit) const noexcept;
  /// The models are not where OpenSees commits.
  [[nodiscard]] bool is_uncommitted() const noexcept;
  /// A specimen is to move for a second time in a step, which ends the test.
  [[nodiscard]] bool iterates() noexcept;
  void command_trials(bool is_trial) noexcept;
  void finish_commit() noexcept;

  OpenSeesLeadSettings settings_;
  ElementPort& port_;
  RowSink& trials_;
  ElementRequest request_;
  std::vector<Element> elements_;
  MotionState current_;
  MotionState completed_;
  Eigen::VectorXd structure_force_n_;  // of one substructure
  Step step_ = 0;
  int iteration_ = 0;
  bool is_trial_ = false;
  bool is_commanded_ = true;     // current() waits for its force; at first that of step 0
  bool is_tried_ = false;        // the models hold a trial
  bool was_away_ = true;         // OpenSees waited since the last next()
  Instant heard_{};              // the last request, or since when the source waits for one
  Instant wait_since_ = kNever;  // for the trials of the other elements
  Instant wake_ = kNever;
  std::optional<LeadEvent> told_;  // the newest refusal
  LeadEnd end_;
};

}  // namespace hybridtest
