#include "report/live/live_answer.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <string_view>

namespace hybridtest {
namespace {

void append_number(fmt::memory_buffer& text, double value, int digits) {
  if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(text), "{:.{}g}", value, digits);
  } else {
    text.append(std::string_view{"null"});
  }
}

void append_array(fmt::memory_buffer& text, std::string_view name, const std::vector<LivePoint>& points,
                  double LivePoint::*value, int digits) {
  fmt::format_to(std::back_inserter(text), ",\"{}\":[", name);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) text.push_back(',');
    append_number(text, points[i].*value, digits);
  }
  text.push_back(']');
}

}  // namespace

std::string to_text(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string to_text(const LiveAnswer& answer) {
  constexpr int kDigits = 7;
  constexpr int kTimeDigits = 9;
  std::string head = to_text(answer.head);
  head.pop_back();  // its closing brace
  fmt::memory_buffer text;
  text.append(head);
  text.append(std::string_view{",\"signals\":["});
  for (std::size_t i = 0; i < answer.signals.size(); ++i) {
    const SignalSlice& signal = answer.signals[i];
    fmt::format_to(std::back_inserter(text),
                   R"({}{{"participant":{},"group":{},"name":{},"subject":{},"unit":{},"limit":)", i > 0 ? "," : "",
                   to_text(nlohmann::json(signal.participant)), to_text(nlohmann::json(signal.group)),
                   to_text(nlohmann::json(signal.name)), to_text(nlohmann::json(signal.subject)),
                   to_text(nlohmann::json(signal.unit)));
    append_number(text, signal.limit, kDigits);
    append_array(text, "t", signal.points, &LivePoint::model_time_s, kTimeDigits);
    append_array(text, "least", signal.points, &LivePoint::least, kDigits);
    append_array(text, "most", signal.points, &LivePoint::most, kDigits);
    append_array(text, "last", signal.points, &LivePoint::last, kDigits);
    text.push_back('}');
  }
  text.append(std::string_view{"]}"});
  return fmt::to_string(text);
}

}  // namespace hybridtest
