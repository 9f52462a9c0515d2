#pragma once

#include <cstdint>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "core/messages.hpp"
#include "transport/fast_dds/dds_version.hpp"
#include "transport/fast_dds/fast_dds_settings.hpp"

namespace hybridtest::fast_dds {

[[nodiscard]] DdsDuration to_dds(Duration duration);

/// The quality of service of a topic, as the protocol needs it.
struct Delivery {
  bool reliable = true;
  bool for_late_joiners = false;  // transient local
  bool heartbeat = false;         // its deadline detects lost participants
  std::int32_t depth = 16;        // newest samples kept per instance, by each end
  std::int32_t reader_depth = 0;  // kept by the reader, if different
  std::int32_t instances = 1;     // largest number of keys at one endpoint
  bool has_many_sizes = false;    // the largest message is far larger than most
  bool is_coupling = false;       // once per step and substructure; see FastDdsSettings::best_effort_coupling
};

/// Topic, wire type and delivery of each message.
template <class Message>
struct Topic;

template <>
struct Topic<TestAnnouncement> {
  using Sample = wire::TestAnnouncement;
  using Type = wire::TestAnnouncementPubSubType;
  static constexpr const char* kName = "hybridtest/4/test_announcement";
  static constexpr Delivery kDelivery{.for_late_joiners = true, .depth = 1};
};

template <>
struct Topic<ParticipantStatus> {
  using Sample = wire::ParticipantStatus;
  using Type = wire::ParticipantStatusPubSubType;
  static constexpr const char* kName = "hybridtest/4/participant_status";
  // The reader keeps more than one because two participants that claim one id write to one
  // instance, and both must be heard for the second to be refused.
  static constexpr Delivery kDelivery{
      .for_late_joiners = true, .heartbeat = true, .depth = 1, .reader_depth = 4, .instances = 128};
};

template <>
struct Topic<DisplacementCommand> {
  using Sample = wire::DisplacementCommand;
  using Type = wire::DisplacementCommandPubSubType;
  static constexpr const char* kName = "hybridtest/4/displacement_command";
  static constexpr Delivery kDelivery{.has_many_sizes = true, .is_coupling = true};
};

template <>
struct Topic<ForceMeasurement> {
  using Sample = wire::ForceMeasurement;
  using Type = wire::ForceMeasurementPubSubType;
  static constexpr const char* kName = "hybridtest/4/force_measurement";
  // More than the one that belongs to a partition: another one there must not take its place.
  static constexpr Delivery kDelivery{.instances = kMaxSubstructures, .has_many_sizes = true, .is_coupling = true};
};

template <>
struct Topic<TestControl> {
  using Sample = wire::TestControl;
  using Type = wire::TestControlPubSubType;
  static constexpr const char* kName = "hybridtest/4/test_control";
  static constexpr Delivery kDelivery{};
};

template <>
struct Topic<Event> {
  using Sample = wire::Event;
  using Type = wire::EventPubSubType;
  static constexpr const char* kName = "hybridtest/4/event";
  static constexpr Delivery kDelivery{.depth = 64, .instances = 128};
};

template <>
struct Topic<SignalBlock> {
  using Sample = wire::SignalBlock;
  using Type = wire::SignalBlockPubSubType;
  static constexpr const char* kName = "hybridtest/4/signal_block";
  static constexpr Delivery kDelivery{.reliable = false, .depth = 4, .instances = 512, .has_many_sizes = true};
};

[[nodiscard]] dds::DataWriterQos writer_qos(const Delivery& delivery, const FastDdsSettings& settings);
[[nodiscard]] dds::DataReaderQos reader_qos(const Delivery& delivery, const FastDdsSettings& settings);

}  // namespace hybridtest::fast_dds
