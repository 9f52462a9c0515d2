#include "experimental_site/rigs/udp_answers.hpp"

namespace hybridtest {
namespace {

/// Distance from `earlier` to `later` in a sequence number that wraps around; negative when `later` comes first.
std::int32_t distance(std::uint32_t earlier, std::uint32_t later) noexcept {
  return static_cast<std::int32_t>(later - earlier);
}

}  // namespace

UdpAnswers::UdpAnswers(int actuators) : actuators_{actuators} {
  newest_.displacement_m = newest_.force_n = SiteVector::Zero(actuators);
}

void UdpAnswers::begin(std::uint32_t next_command) noexcept {
  first_command_ = next_command;
  has_any_ = false;
  last_defect_ = DatagramDefect::none;
}

void UdpAnswers::take(std::span<const std::byte> bytes, std::uint32_t last_command) noexcept {
  const DatagramDefect defect = read(bytes);
  if (defect != DatagramDefect::none) {
    last_defect_ = defect;
    ++counts_.invalid;
    return;
  }
  if (!answers_one_of(last_command)) {
    ++counts_.invalid;
    return;
  }
  if (has_any_) {
    const std::int32_t ahead = distance(newest_.sequence, arrived_.sequence);
    if (ahead <= 0) {
      ++counts_.stale;
      return;
    }
    counts_.skipped += static_cast<std::uint32_t>(ahead) - 1;
  }
  newest_ = arrived_;
  has_any_ = true;
  ++counts_.received;
}

DatagramDefect UdpAnswers::read(std::span<const std::byte> bytes) noexcept {
  const DatagramDefect defect = decode(bytes, arrived_);
  if (defect != DatagramDefect::none) return defect;
  return arrived_.displacement_m.size() == actuators_ ? defect : DatagramDefect::actuators;
}

bool UdpAnswers::answers_one_of(std::uint32_t last_command) const noexcept {
  return distance(first_command_, arrived_.command_sequence) >= 0 &&
         distance(arrived_.command_sequence, last_command) >= 0;
}

}  // namespace hybridtest
