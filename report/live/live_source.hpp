#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "core/messages.hpp"
#include "core/time.hpp"
#include "report/live/live_answer.hpp"

namespace hybridtest {

/// What the server of the live view asks. Any thread; no call waits for the network.
class LiveSource {
 public:
  virtual ~LiveSource() = default;

  /// An array with TestView::entry() of each.
  [[nodiscard]] virtual nlohmann::json tests(Instant now) const = 0;
  /// See TestView; nothing for a test that is not known.
  [[nodiscard]] virtual std::optional<LiveAnswer> news(std::string_view test, std::uint64_t since,
                                                       Instant now) const = 0;
  [[nodiscard]] virtual std::optional<LiveAnswer> whole(std::string_view test) const = 0;
  /// Sends a request of the operator at once, and repeats it until it is obeyed.
  /// @return false for a test that is not known.
  virtual bool request(std::string_view test, ControlVerb verb, Instant now) = 0;
};

}  // namespace hybridtest
