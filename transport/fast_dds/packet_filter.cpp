#include "transport/fast_dds/packet_filter.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <string_view>

namespace hybridtest::fast_dds {
namespace {

using Bytes = PacketFilter::Bytes;

enum Submessage : std::uint8_t {
  kAckNack = 0x06,
  kHeartbeat = 0x07,
  kGap = 0x08,
  kInfoTimestamp = 0x09,
  kInfoDestination = 0x0e,
  kData = 0x15,
  kDataFragment = 0x16,
  kSecureBody = 0x30,
  kSecurePrefix = 0x31,
  kSecurePostfix = 0x32,
  kSecureMessagePrefix = 0x33,
  kSecureMessagePostfix = 0x34,
  kStatistics = 0x80,  // of Fast DDS
};
constexpr std::uint8_t kPad = 0x01;

constexpr std::size_t kHeaderBytes = 20;
constexpr std::size_t kVendorAt = 6;
constexpr std::size_t kPrefixAt = 8;
// Flags of DATA.
constexpr std::uint8_t kHasInlineQos = 0x02;
constexpr std::uint8_t kHasData = 0x04;
constexpr std::uint8_t kHasKey = 0x08;
constexpr std::uint8_t kFragmentIsKey = 0x04;
// From the field that says so to the parameters in front of the data: identities and number, and which fragments.
constexpr std::uint32_t kToParameters = 16;
constexpr std::uint32_t kToParametersOfFragment = 28;
// Reader and writer of announcements, and of the authentication.
constexpr std::array<std::uint8_t, 8> kAnnouncing{0x00, 0x01, 0x00, 0xc7, 0x00, 0x01, 0x00, 0xc2};
constexpr std::array<std::uint8_t, 8> kAuthenticating{0x00, 0x02, 0x01, 0xc4, 0x00, 0x02, 0x01, 0xc3};
// Parameters: in front of the data, and of an announcement.
constexpr std::uint16_t kSampleIdentity = 0x800f;
constexpr std::uint16_t kStatusInfo = 0x0071;
constexpr std::uint16_t kEndOfList = 0x0001;
constexpr std::uint16_t kParticipantGuid = 0x0050;
constexpr std::uint16_t kProperties = 0x0059;
constexpr std::uint16_t kIdentityToken = 0x1001;
constexpr std::uint16_t kPermissionsToken = 0x1002;

/// Reads CDR; after what is not there, everything is 0 and is_good() false.
class Reader {
 public:
  Reader(Bytes bytes, bool is_little) : bytes_{bytes}, is_little_{is_little} {}

  [[nodiscard]] bool is_good() const noexcept { return is_good_; }
  [[nodiscard]] Bytes rest() const noexcept { return bytes_.subspan(at_); }

  Bytes take(std::size_t count) noexcept {
    if (!is_good_ || count > bytes_.size() - at_) {
      is_good_ = false;
      return {};
    }
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }
  std::uint32_t number(std::size_t size) noexcept {
    const Bytes digits = take(size);
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < digits.size(); ++i) value = value << 8U | digits[is_little_ ? size - 1 - i : i];
    return value;
  }
  std::uint64_t sequence_number() noexcept {
    const std::uint64_t high = number(4);
    return high << 32U | number(4);
  }
  /// Strings and octets: their length, themselves, and what fills up to the next multiple of four.
  void counted_bytes() noexcept {
    static_cast<void>(take(number(4)));
    static_cast<void>(take(std::min((4 - at_ % 4) % 4, bytes_.size() - at_)));
  }
  /// @param each   two counted strings or octets.
  void pairs() noexcept {
    const std::uint32_t count = number(4);
    for (std::uint32_t i = 0; i < count && is_good_; ++i) {
      counted_bytes();
      counted_bytes();
    }
  }
  /// A token: its class, properties, binary properties.
  void token() noexcept {
    counted_bytes();
    pairs();
    pairs();
  }

 private:
  Bytes bytes_;
  bool is_little_;
  std::size_t at_ = 0;
  bool is_good_ = true;
};

struct Part {
  std::uint8_t id = 0;
  std::uint8_t flags = 0;
  Bytes bytes;

  [[nodiscard]] bool is_little() const noexcept { return (flags & 1U) != 0; }
};

/// Takes the first submessage off `rest`; nothing where none is whole.
std::optional<Part> next_part(Bytes& rest) noexcept {
  if (rest.size() < 4) return std::nullopt;
  Part part{.id = rest[0], .flags = rest[1], .bytes = {}};
  std::size_t length = Reader{rest.subspan(2, 2), part.is_little()}.number(2);
  // The last one may leave its length open.
  if (length == 0 && part.id != kPad && part.id != kInfoTimestamp) length = rest.size() - 4;
  if (length > rest.size() - 4) return std::nullopt;
  part.bytes = rest.subspan(4, length);
  rest = rest.subspan(4 + length);
  return part;
}

/// What it says about messages could be true.
bool has_sane_range(const Part& part) noexcept {
  if (part.id != kAckNack && part.id != kHeartbeat && part.id != kGap) return true;
  Reader reader{part.bytes, part.is_little()};
  static_cast<void>(reader.take(8));  // of whom and to whom
  const std::uint64_t first = reader.sequence_number();
  const std::uint64_t last = part.id == kAckNack ? first : reader.sequence_number();
  if (!reader.is_good()) return true;  // Fast DDS refuses it
  // The first one of a heartbeat is one more than the last one when there is none.
  return first <= PacketFilter::kSequenceMax && last <= PacketFilter::kSequenceMax &&
         (last <= first || last - first <= PacketFilter::kRangeMax);
}

/// Takes the parameters in front of the data.
void skip_parameters(Reader& reader) noexcept {
  while (reader.is_good()) {
    const std::uint32_t what = reader.number(2);
    static_cast<void>(reader.take(reader.number(2)));
    if (what == kEndOfList) return;
  }
}

/// Which fragments of a message it brings could be true. Takes what says so.
bool takes_sane_fragments(Reader& reader) noexcept {
  const std::uint64_t first = reader.number(4);
  const std::uint64_t count = reader.number(2);
  const std::uint64_t bytes_of_one = reader.number(2);
  const std::uint64_t bytes_of_all = reader.number(4);
  return reader.is_good() && first > 0 && count > 0 && bytes_of_one > 0 &&
         (first + count - 2) * bytes_of_one < bytes_of_all && bytes_of_all <= PacketFilter::kMessageMax;
}

/// The data are where they should be. Of others Fast DDS 2.9 copies what lies behind the packet, or frees what it has
/// not allocated.
bool has_sane_data(const Part& part) noexcept {
  if (part.id != kData && part.id != kDataFragment) return true;
  const bool is_fragment = part.id == kDataFragment;
  const bool has_key = (part.flags & (is_fragment ? kFragmentIsKey : kHasKey)) != 0;
  const bool has_data = is_fragment || (part.flags & kHasData) != 0;
  if (has_key && has_data) return false;
  Reader reader{part.bytes, part.is_little()};
  static_cast<void>(reader.take(2));
  if (reader.number(2) != (is_fragment ? kToParametersOfFragment : kToParameters)) return false;
  static_cast<void>(reader.take(kToParameters));
  if (is_fragment && !takes_sane_fragments(reader)) return false;
  if ((part.flags & kHasInlineQos) != 0) skip_parameters(reader);
  return reader.is_good() && ((!has_data && !has_key) || !reader.rest().empty());
}

/// Does no harm to Fast DDS.
bool is_sane(Bytes packet) noexcept {
  if (packet.size() < kHeaderBytes) return true;  // Fast DDS refuses it
  constexpr std::array<std::uint8_t, 2> kFastDds{0x01, 0x0f};
  const bool has_statistics = std::ranges::equal(packet.subspan(kVendorAt, 2), kFastDds);
  Bytes rest = packet.subspan(kHeaderBytes);
  while (const auto part = next_part(rest)) {
    if (!has_sane_range(*part) || !has_sane_data(*part)) return false;
    // Fast DDS looks for the next part at the next multiple of four, where it would find other parts than we do. It
    // ends the process on an assertion when its statistics are not the last part.
    if (!rest.empty() && (part->bytes.size() % 4 != 0 || (has_statistics && part->id == kStatistics))) return false;
  }
  return true;
}

/// The serialised data of a DATA submessage; nothing when it says more than what is needed, such as that something
/// ended.
std::optional<Bytes> payload_of(const Part& data) noexcept {
  if ((data.flags & kHasData) == 0) return std::nullopt;
  Reader reader{data.bytes, data.is_little()};
  static_cast<void>(reader.take(2));
  if (reader.number(2) != kToParameters) return std::nullopt;
  static_cast<void>(reader.take(kToParameters));
  while ((data.flags & kHasInlineQos) != 0 && reader.is_good()) {
    const std::uint32_t what = reader.number(2);
    static_cast<void>(reader.take(reader.number(2)));
    if (what == kEndOfList) break;
    if (what != kSampleIdentity) return std::nullopt;
  }
  if (!reader.is_good()) return std::nullopt;
  return reader.rest();
}

bool goes_between(const Part& data, const std::array<std::uint8_t, 8>& endpoints) noexcept {
  return data.bytes.size() >= 12 && std::ranges::equal(data.bytes.subspan(4, 8), endpoints);
}

/// Says that a participant has left, as Fast DDS does when it ends.
bool is_departure(const Part& data) noexcept {
  if (!goes_between(data, kAnnouncing) || (data.flags & kHasInlineQos) == 0) return false;
  Reader reader{data.bytes, data.is_little()};
  static_cast<void>(reader.take(20));  // two identities and the number
  while (reader.is_good()) {
    const std::uint32_t what = reader.number(2);
    if (what == kStatusInfo) return true;
    if (what == kEndOfList) return false;
    static_cast<void>(reader.take(reader.number(2)));
  }
  return false;
}

/// A list of parameters, each as long as it says, of the participant with this prefix.
bool is_announcement(Bytes payload, Bytes prefix) noexcept {
  if (payload.size() < 4 || payload[0] != 0 || (payload[1] != 2 && payload[1] != 3)) return false;
  const bool is_little = payload[1] == 3;
  bool is_of_sender = false;
  for (Reader list{payload.subspan(4), is_little}; list.is_good();) {
    const auto what = static_cast<std::uint16_t>(list.number(2));
    const Bytes value = list.take(list.number(2));
    if (!list.is_good()) return false;
    if (what == kEndOfList) return is_of_sender;
    Reader reader{value, is_little};
    if (what == kIdentityToken || what == kPermissionsToken) reader.token();
    if (what == kProperties) reader.pairs();
    if (!reader.is_good()) return false;
    if (what != kParticipantGuid) continue;
    is_of_sender = value.size() == 16 && std::ranges::equal(value.first(12), prefix);
    if (!is_of_sender) return false;
  }
  return false;
}

/// A message of the authentication whose parts are as long as they say.
bool is_authentication(Bytes payload) noexcept {
  constexpr std::size_t kIdentities = 2 * 24 + 3 * 16;
  if (payload.size() < 4 || payload[0] != 0 || payload[1] > 1) return false;
  Reader reader{payload.subspan(4), payload[1] == 1};
  static_cast<void>(reader.take(kIdentities));
  reader.counted_bytes();
  const std::uint32_t tokens = reader.number(4);
  for (std::uint32_t i = 0; i < tokens && reader.is_good(); ++i) reader.token();
  return reader.is_good();
}

bool refuse(std::atomic<std::uint64_t>& count) noexcept {
  count.fetch_add(1, std::memory_order_relaxed);
  return false;
}

/// The packet is one encrypted message and nothing else.
bool is_encrypted(Bytes packet) noexcept {
  if (packet.size() < kHeaderBytes) return false;
  Bytes rest = packet.subspan(kHeaderBytes);
  for (const std::uint8_t expected : {kSecureMessagePrefix, kSecureBody, kSecureMessagePostfix}) {
    const auto part = next_part(rest);
    if (!part || part->id != expected) return false;
  }
  const auto last = rest.empty() ? std::nullopt : next_part(rest);
  return rest.empty() && (!last || last->id == kStatistics);
}

}  // namespace

bool PacketFilter::admits_message(Bytes packet) const noexcept {
  if (!is_sane(packet)) return refuse(refused_->harmful);
  return admission_ == Admission::plain || is_encrypted(packet) || refuse(refused_->in_plain_text);
}

bool PacketFilter::admits_discovery(Bytes packet, Time now) {
  if (!is_sane(packet)) return refuse(refused_->harmful);
  if (admission_ != Admission::secured || is_encrypted(packet)) return true;
  if (packet.size() < kHeaderBytes) return refuse(refused_->in_plain_text);
  const Bytes prefix = packet.subspan(kPrefixAt, 12);
  Bytes rest = packet.subspan(kHeaderBytes);
  while (!rest.empty()) {
    const auto part = next_part(rest);
    if (!part) return refuse(refused_->in_plain_text);
    switch (part->id) {
      case kInfoTimestamp:
      case kInfoDestination:
      // The keys of a session, encrypted one by one.
      case kSecurePrefix:
      case kSecureBody:
      case kSecurePostfix: break;
      case kData: {
        const auto payload = payload_of(*part);
        if (!payload) {
          return refuse(is_departure(*part) ? refused_->departures : refused_->in_plain_text);
        }
        if (goes_between(*part, kAuthenticating)) {
          if (!is_authentication(*payload)) return refuse(refused_->announcements);
          break;
        }
        if (!goes_between(*part, kAnnouncing)) return refuse(refused_->in_plain_text);
        Prefix sender{};
        std::ranges::copy(prefix, sender.begin());
        const Belief belief =
            is_announcement(*payload, prefix) ? belief_in(sender, part->bytes, now) : Belief::contradicted;
        if (belief == Belief::contradicted) return refuse(refused_->announcements);
        if (belief == Belief::unrepeated) return false;
        break;
      }
      case kStatistics: break;
      default: return refuse(refused_->in_plain_text);
    }
  }
  return true;
}

PacketFilter::Belief PacketFilter::belief_in(const Prefix& prefix, Bytes announcement, Time now) {
  if (announcements_.size() >= kParticipantsMax && !announcements_.contains(prefix)) {
    std::erase_if(announcements_, [now](const auto& one) { return now - one.second.heard > kSilence; });
    if (announcements_.size() >= kParticipantsMax) return Belief::contradicted;
  }
  Announcements& of_it = announcements_[prefix];
  if (now - of_it.heard > kSilence) of_it.believed.clear();
  if (!of_it.believed.empty()) {
    if (!std::ranges::equal(of_it.believed, announcement)) return Belief::contradicted;
    of_it.heard = now;
    return Belief::believed;
  }
  of_it.heard = now;
  const std::size_t content =
      std::hash<std::string_view>{}({reinterpret_cast<const char*>(announcement.data()), announcement.size()});
  if (of_it.times.size() >= kContentsMax) of_it.times.clear();
  const int times = ++of_it.times[content];
  int others = 0;
  for (const auto& [other, its_times] : of_it.times) {
    if (other != content) others = std::max(others, its_times);
  }
  if (times < others + kLead) return others == 0 ? Belief::unrepeated : Belief::contradicted;
  of_it.believed.assign(announcement.begin(), announcement.end());
  of_it.times.clear();
  return Belief::believed;
}

}  // namespace hybridtest::fast_dds
