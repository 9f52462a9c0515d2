#include <algorithm>

#include "transport/fast_dds/topics.hpp"

namespace hybridtest::fast_dds {
namespace {

// Settings common to writers and readers.
template <class Qos>
void set_delivery(const Delivery& delivery, std::int32_t depth, const FastDdsSettings& settings, Qos& qos) {
  const bool is_sent_again = delivery.reliable && !(delivery.is_coupling && settings.best_effort_coupling);
  qos.reliability().kind = is_sent_again ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind =
      delivery.for_late_joiners ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = depth;
  qos.resource_limits().max_samples_per_instance = depth;
  qos.resource_limits().max_instances = delivery.instances;
  qos.resource_limits().max_samples = depth * delivery.instances;
  qos.resource_limits().allocated_samples = std::min(qos.resource_limits().max_samples, 64);
  qos.endpoint().history_memory_policy = delivery.has_many_sizes ? kReused : kPreallocated;
  // Data sharing uses files shared by processes; files of a killed process block the others.
  qos.data_sharing().off();
  if (delivery.heartbeat) {
    // Not its liveliness as well: where a reader has a lease, Fast DDS 2.9 goes through the list of all readers of the
    // process when a sample arrives, without a lock. The process ended when another reader was made at that moment.
    qos.deadline().period = to_dds(settings.heartbeat_deadline);
  }
}

}  // namespace

DdsDuration to_dds(Duration duration) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(duration);
  return {static_cast<std::int32_t>(seconds.count()), static_cast<std::uint32_t>((duration - seconds).count())};
}

dds::DataWriterQos writer_qos(const Delivery& delivery, const FastDdsSettings& settings) {
  dds::DataWriterQos qos;
  set_delivery(delivery, delivery.depth, settings, qos);
  // The calling thread sends: no queue and no thread switch delays a command.
  qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  qos.reliability().max_blocking_time = to_dds(std::chrono::milliseconds{10});
  qos.reliable_writer_qos().times.heartbeatPeriod = to_dds(settings.repair_period);
  qos.reliable_writer_qos().times.nackResponseDelay = to_dds(Duration{0});
  // Otherwise each message asks for a receipt, for which timers are set and threads wake at both ends. A lost message
  // takes that question with it: only the repeated one above finds out.
  qos.reliable_writer_qos().disable_heartbeat_piggyback = delivery.is_coupling;
  // For this time after a message was sent, a request to repeat it is older than the message. With no time at all Fast
  // DDS wakes a thread after each write.
  if (delivery.is_coupling) qos.reliable_writer_qos().times.nackSupressionDuration = to_dds(settings.repair_period / 2);
  return qos;
}

dds::DataReaderQos reader_qos(const Delivery& delivery, const FastDdsSettings& settings) {
  dds::DataReaderQos qos;
  set_delivery(delivery, delivery.reader_depth > 0 ? delivery.reader_depth : delivery.depth, settings, qos);
  if (settings.is_observer) {
    qos.deadline() = dds::DataReaderQos{}.deadline();
  }
  if (settings.reads_best_effort && !delivery.for_late_joiners) {
    qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
  }
  return qos;
}

}  // namespace hybridtest::fast_dds
