#pragma once

#include "core/messages.hpp"
#include "hybridtest.h"

/// Converts between the messages of core/ and their form on the network; the only place that knows both.
///
/// encode() accepts any message that core/ can hold. decode() checks everything: it returns false,
/// leaving `message` in an unspecified but valid state, when a count exceeds its limit, a
/// number is no enumerator or holds unknown flags, or a step, time or substructure is out of
/// the range that the IDL states. Displacements and forces may be NaN or infinite; the nodes
/// handle these. Messages of each step allocate when they grow: encoded into the same sample and decoded into the same
/// message again, one of the same interface does not.
namespace hybridtest::fast_dds {

void encode(const TestAnnouncement& message, wire::TestAnnouncement& sample);
void encode(const ParticipantStatus& message, wire::ParticipantStatus& sample);
void encode(const DisplacementCommand& message, wire::DisplacementCommand& sample);
void encode(const ForceMeasurement& message, wire::ForceMeasurement& sample);
void encode(const TestControl& message, wire::TestControl& sample) noexcept;
void encode(const Event& message, wire::Event& sample);
void encode(const SignalBlock& message, wire::SignalBlock& sample);

[[nodiscard]] bool decode(const wire::TestAnnouncement& sample, TestAnnouncement& message) noexcept;
[[nodiscard]] bool decode(const wire::ParticipantStatus& sample, ParticipantStatus& message) noexcept;
[[nodiscard]] bool decode(const wire::DisplacementCommand& sample, DisplacementCommand& message);
[[nodiscard]] bool decode(const wire::ForceMeasurement& sample, ForceMeasurement& message);
[[nodiscard]] bool decode(const wire::TestControl& sample, TestControl& message) noexcept;
[[nodiscard]] bool decode(const wire::Event& sample, Event& message) noexcept;
[[nodiscard]] bool decode(const wire::SignalBlock& sample, SignalBlock& message) noexcept;

}  // namespace hybridtest::fast_dds
