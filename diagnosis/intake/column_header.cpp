#include "diagnosis/intake/column_header.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "core/text/shown.hpp"

namespace hybridtest {
namespace {

constexpr std::array<std::string_view, 6> kLeftAside{"sample",         "model_time_s",      "compensated_force_n",
                                                     "energy_error_j", "tracking_lag_sine", "faults"};
constexpr std::string_view kPredicted = "predicted_";

Channel channel_at(std::size_t index) { return static_cast<Channel>(index); }

/// `_2` as 1; nothing for what is no such suffix.
std::optional<std::size_t> dof_of_suffix(std::string_view suffix) {
  if (suffix.empty()) return 0;
  if (suffix.size() < 2 || suffix.front() != '_' || suffix[1] == '0') return {};
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(suffix.data() + 1, suffix.data() + suffix.size(), number);
  if (error != std::errc{} || end != suffix.data() + suffix.size() || number > kMostDofs) return {};
  return number - 1;
}

}  // namespace

std::optional<ChannelColumn> channel_of_header(std::string_view header) {
  for (std::size_t i = 0; i < kChannels; ++i) {
    const std::string_view name = column_name(channel_at(i));
    if (!header.starts_with(name)) continue;
    if (const auto dof = dof_of_suffix(header.substr(name.size()))) return ChannelColumn{channel_at(i), *dof};
  }
  return {};
}

bool is_left_aside(std::string_view header) {
  if (header.starts_with(kPredicted)) return true;
  return std::ranges::any_of(kLeftAside, [&](std::string_view name) {
    return header.starts_with(name) && dof_of_suffix(header.substr(name.size())).has_value();
  });
}

std::string unknown_column_advice(std::string_view header) {
  std::vector<std::string> known{std::string{kTimeColumn}};
  for (std::size_t i = 0; i < kChannels; ++i) known.emplace_back(column_name(channel_at(i)));
  return "unknown column" + name_advice(header, known, "known here") + "; _1, _2 ... for several degrees of freedom";
}

}  // namespace hybridtest
