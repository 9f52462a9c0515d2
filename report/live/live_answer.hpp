#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/live/signal_history.hpp"

namespace hybridtest {

/// One signal in an answer.
struct SignalSlice {
  std::string participant;
  std::string group;
  std::string name;
  std::string subject;
  std::string unit;
  double limit = 0.0;  // [unit]; NaN without one
  std::vector<LivePoint> points;
};

/// What a page is told of a test, copied so that it is written without holding up the observer.
struct LiveAnswer {
  nlohmann::json head;  // an object: everything but the signals
  std::vector<SignalSlice> signals;
};

/// The answer as one JSON object, with `signals` last. Numbers have seven significant digits, times nine; those that
/// are not finite are null, bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string to_text(const LiveAnswer& answer);
[[nodiscard]] std::string to_text(const nlohmann::json& json);

}  // namespace hybridtest
