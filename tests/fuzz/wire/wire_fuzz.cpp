#include "tests/fuzz/wire/wire_fuzz.hpp"

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <algorithm>
#include <atomic>
#include <vector>

#include "core/assert.hpp"
#include "transport/fast_dds/topics.hpp"
#include "transport/fast_dds/wire_mapping.hpp"

namespace hybridtest {
namespace {

template <class Sample>
std::vector<char> to_bytes(const Sample& sample) {
  std::vector<char> bytes(Sample::getMaxCdrSerializedSize() + 4);
  eprosima::fastcdr::FastBuffer buffer{bytes.data(), bytes.size()};
  eprosima::fastcdr::Cdr out{buffer};
  sample.serialize(out);
  bytes.resize(out.getSerializedDataLength());
  return bytes;
}

/// As the inbox of the topic treats what it receives.
template <class Message>
WireFuzzOutcome fuzz_topic(const std::uint8_t* bytes, std::size_t size) {
  using Sample = typename fast_dds::Topic<Message>::Sample;
  std::atomic<std::uint64_t> malformed{0};
  fast_dds::CheckedType<typename fast_dds::Topic<Message>::Type> type{malformed};
  fast_dds::Payload payload{static_cast<std::uint32_t>(std::max<std::size_t>(size, 1))};
  std::copy_n(bytes, size, payload.data);
  payload.length = static_cast<std::uint32_t>(size);
  Sample sample;
  if (!type.deserialize(&payload, &sample)) {
    HYBRIDTEST_ASSERT(malformed == 1);
    return WireFuzzOutcome::unreadable;
  }
  HYBRIDTEST_ASSERT(malformed == 0);
  fast_dds::InstanceHandle key;
  static_cast<void>(type.getKey(&sample, &key, false));
  Message message;
  if (!fast_dds::decode(sample, message)) return WireFuzzOutcome::refused;

  Sample sent_on;
  fast_dds::encode(message, sent_on);
  Message received;
  HYBRIDTEST_ASSERT(fast_dds::decode(sent_on, received));
  Sample again;
  fast_dds::encode(received, again);
  HYBRIDTEST_ASSERT(to_bytes(sent_on) == to_bytes(again));
  return WireFuzzOutcome::accepted;
}

}  // namespace

WireFuzzOutcome fuzz_wire(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return WireFuzzOutcome::unreadable;
  const std::uint8_t topic = bytes[0] % kWireFuzzTopics;
  ++bytes;
  --size;
  switch (topic) {
    case 0: return fuzz_topic<TestAnnouncement>(bytes, size);
    case 1: return fuzz_topic<ParticipantStatus>(bytes, size);
    case 2: return fuzz_topic<DisplacementCommand>(bytes, size);
    case 3: return fuzz_topic<ForceMeasurement>(bytes, size);
    case 4: return fuzz_topic<TestControl>(bytes, size);
    case 5: return fuzz_topic<Event>(bytes, size);
    default: return fuzz_topic<SignalBlock>(bytes, size);
  }
}

}  // namespace hybridtest

#ifdef HYBRIDTEST_LIBFUZZER
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static_cast<void>(hybridtest::fuzz_wire(bytes, size));
  return 0;
}
#endif
