#pragma once

#include "core/messages.hpp"
#include "core/time.hpp"

namespace hybridtest {

/// When a command that one substructure has not answered is sent to it again. Each copy is answered, and nothing moves
/// twice: a command and its answer are lost together only when all copies are.
///
/// The first patience is given. Later an answer is late after the usual round trip, smoothed, plus four times its usual
/// deviation (Jacobson, 1988; RFC 6298), and the time that the substructure itself takes. Then the command is sent ten
/// times in a round trip, so that one of them gets out of a burst of losses, and gradually less often, at last in
/// intervals of the given patience.
///
/// Where first copies or their answers were lost lately, several copies are sent without waiting for the answer, some
/// milliseconds apart: so many that all of them are lost in two steps of a thousand, six at most. The echo of the send
/// time tells which copy was answered. With no loss nothing more is sent.
class CommandRepeats {
 public:
  static constexpr int kCopiesMost = 6;

  /// @param patience      with a substructure of which nothing is known yet, and the longest between two repeats.
  /// @param turnaround    that a substructure takes at least, from the command to the answer.
  CommandRepeats(Duration patience, Duration turnaround) noexcept
      : patience_{patience}, turnaround_least_{turnaround} {}

  /// A new command was sent for the first time.
  void open(Instant now) noexcept;
  void sent_again(Instant now) noexcept;
  /// The first answer to the open command.
  void answered(const ForceMeasurement& answer, Instant now) noexcept;

  /// When the open command is to be sent again; kNever once it is answered.
  [[nodiscard]] Instant due() const noexcept { return due_; }
  /// Once for each command: it was not answered for the given patience.
  [[nodiscard]] bool becomes_overdue(Instant now) noexcept;
  /// Of the command that is sent next.
  [[nodiscard]] int copies() const noexcept;
  /// Share of the first copies that were lost, or their answers, lately.
  [[nodiscard]] double loss() const noexcept { return loss_; }

 private:
  /// Of the net round trip or of the turnaround.
  struct Usual {
    Duration mean{};
    Duration deviation{};
    bool is_known = false;

    void add(Duration sample) noexcept;
  };

  [[nodiscard]] Duration spacing() const noexcept;
  [[nodiscard]] Duration turnaround() const noexcept;
  /// Sent without waiting longer than the usual time.
  [[nodiscard]] int planned() const noexcept;
  /// From the first copy, copy 0, to this one.
  [[nodiscard]] Duration time_of(int copy) const noexcept;
  /// From the first copy until the answer is late. @param planned   copies.
  [[nodiscard]] Duration late_after(int planned) const noexcept;
  /// Between two copies once it is late. @param number   of those that were sent since.
  [[nodiscard]] Duration interval(int number) const noexcept;
  void plan(Instant now) noexcept;

  Duration patience_;
  Duration turnaround_least_;
  Usual net_;  // what the network takes, there and back, and the computing on both sides
  Usual turnaround_;
  double loss_ = 0.0;
  Instant opened_{};
  int sent_ = 0;  // copies of the open command
  bool is_overdue_ = false;
  Instant due_ = kNever;
};

}  // namespace hybridtest
