#pragma once

#include <atomic>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include "experimental_site/rigs/rig.hpp"

namespace hybridtest {

/// What the library of a drive vendor offers: one axis.
class Drive {
 public:
  virtual ~Drive() = default;
  virtual bool open(const std::string& name) = 0;  // may take long
  virtual void enable(bool on) noexcept = 0;       // any thread
  virtual bool write_target_mm(double target_mm) noexcept = 0;
  virtual bool read(double& position_mm, double& force_kn) noexcept = 0;
};

// The text between the two marks is quoted by docs/writing_a_rig.md; a test compares them.
// [example]
/// One actuator behind a vendor's drive that works in millimetres and kilonewtons.
class DriveRig final : public Rig {
 public:
  DriveRig(std::string name, Drive& drive) : name_{std::move(name)}, drive_{drive} {}

  void connect() override {
    drive_.enable(false);
    if (!drive_.open(name_)) throw std::runtime_error{"the drive " + name_ + " cannot be opened: is it switched on?"};
    phase_ = Phase::connected;
  }

  void arm() override {
    // One atomic step, so that it cannot undo a stop_motion() from another thread.
    Phase expected = Phase::connected;
    if (!phase_.compare_exchange_strong(expected, Phase::armed)) {
      if (expected == Phase::armed) return;
      throw std::runtime_error{"the drive " + name_ + " cannot be armed: call connect() first, also after a stop"};
    }
    drive_.enable(true);
    if (phase_ != Phase::armed) drive_.enable(false);  // stopped in the meantime
  }

  RigStatus exchange(const ActuatorCommand& command, RigFeedback& feedback) noexcept override {
    const Phase phase = phase_;
    if (phase == Phase::disconnected) return RigStatus::fault;
    if (command.displacement_m.size() != 1 || feedback.displacement_m.size() != 1 || feedback.force_n.size() != 1) {
      return RigStatus::fault;
    }
    if (!command.displacement_m.allFinite()) return RigStatus::fault;
    if (phase == Phase::armed && !drive_.write_target_mm(1e3 * command.displacement_m[0])) return RigStatus::fault;
    double position_mm = 0.0;
    double force_kn = 0.0;
    if (!drive_.read(position_mm, force_kn)) return RigStatus::fault;  // the feedback stays the last good one
    feedback.displacement_m[0] = 1e-3 * position_mm;
    feedback.force_n[0] = 1e3 * force_kn;
    return RigStatus::healthy;
  }

  void stop_motion() noexcept override {
    phase_ = Phase::stopped;
    drive_.enable(false);
  }

 private:
  enum class Phase : std::uint8_t { disconnected, connected, armed, stopped };

  std::string name_;
  Drive& drive_;
  std::atomic<Phase> phase_{Phase::disconnected};
};
// [example]

}  // namespace hybridtest
