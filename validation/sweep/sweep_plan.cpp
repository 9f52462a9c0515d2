#include "validation/sweep/sweep_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/config_error.hpp"
#include "validation/studies/output_file.hpp"

namespace hybridtest {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 6> kNetwork{"latency_us", "latency_spread", "jitter_us",
                                                   "loss",       "duplication",    "reordering"};
constexpr std::string_view kSiteLatency = "site_latency_us[";
constexpr std::size_t kCasesMax = 1'000'000;

[[noreturn]] void refuse(std::string_view option, std::string_view text, std::string_view what) {
  throw ConfigError{fmt::format("{} {}: {}", option, text, what)};
}

/// At the commas outside brackets, braces and quotes.
std::vector<std::string> split_values(std::string_view text) {
  std::vector<std::string> values(1);
  int depth = 0;
  char quote = 0;
  for (const char letter : text) {
    if (quote != 0) {
      if (letter == quote) quote = 0;
    } else if (letter == '"' || letter == '\'') {
      quote = letter;
    } else if (letter == '[' || letter == '{') {
      ++depth;
    } else if (letter == ']' || letter == '}') {
      --depth;
    } else if (letter == ',' && depth == 0) {
      values.emplace_back();
      continue;
    }
    values.back() += letter;
  }
  return values;
}

/// `low..high/count` or `low..high/count/log`; nothing for a text of another form.
std::optional<std::vector<std::string>> read_range(std::string_view key, std::string_view text) {
  const auto dots = text.find("..");
  const auto slash = text.find('/');
  if (dots == std::string_view::npos || slash == std::string_view::npos || slash < dots) return {};
  const auto low = number_of(text.substr(0, dots));
  const auto high = number_of(text.substr(dots + 2, slash - dots - 2));
  std::string_view rest = text.substr(slash + 1);
  const bool is_log = rest.ends_with("/log");
  if (is_log) rest.remove_suffix(4);
  const auto count = number_of(rest);
  if (!low || !high || !count || *count != std::floor(*count)) return {};
  if (*count < 2.0 || *count > 100'000.0) refuse("--vary", key, "a range has 2 to 100000 values");
  if (is_log && (*low <= 0.0 || *high <= 0.0)) refuse("--vary", key, "a range with log has limits above zero");
  std::vector<std::string> values;
  for (int i = 0; i < static_cast<int>(*count); ++i) {
    const double share = i / (*count - 1.0);
    const double value = is_log ? *low * std::pow(*high / *low, share) : *low + share * (*high - *low);
    values.push_back(fmt::format("{:.10g}", value));
  }
  return values;
}

std::string with_seed(std::string text, std::uint64_t seed) {
  for (std::size_t at = text.find(kSeedValue); at != std::string::npos; at = text.find(kSeedValue)) {
    text.replace(at, kSeedValue.size(), std::to_string(seed));
  }
  return text;
}

}  // namespace

std::optional<double> number_of(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

std::optional<std::string> site_of_latency(std::string_view key) {
  if (!key.starts_with(kSiteLatency) || !key.ends_with(']')) return {};
  return std::string{key.substr(kSiteLatency.size(), key.size() - kSiteLatency.size() - 1)};
}

Varied read_varied(std::string_view text) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos || equals == 0 || equals + 1 == text.size()) {
    refuse("--vary", text, "expected key.path=value,value,... or key.path=low..high/count");
  }
  Varied varied{std::string{text.substr(0, equals)}, {}};
  const std::string_view values = text.substr(equals + 1);
  varied.values = read_range(varied.key, values).value_or(split_values(values));
  if (std::ranges::any_of(varied.values, &std::string::empty)) refuse("--vary", text, "one of the values is empty");
  std::vector<std::string> sorted = varied.values;
  std::ranges::sort(sorted);
  if (std::ranges::adjacent_find(sorted) != sorted.end()) refuse("--vary", text, "one of the values is there twice");
  return varied;
}

std::pair<std::uint64_t, std::uint64_t> read_seeds(std::string_view text) {
  const auto dots = text.find("..");
  const auto read = [&](std::string_view digits) {
    std::uint64_t seed = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), seed);
    if (error != std::errc{} || end != digits.data() + digits.size()) {
      refuse("--seeds", text, "expected one number, or first..last");
    }
    return seed;
  };
  const std::uint64_t first = read(text.substr(0, dots));
  const std::uint64_t last = dots == std::string_view::npos ? first : read(text.substr(dots + 2));
  if (last < first) refuse("--seeds", text, "the last seed is below the first");
  if (last - first >= kCasesMax) refuse("--seeds", text, "more than a million seeds");
  return {first, last};
}

std::size_t SweepPlan::case_count() const noexcept {
  std::size_t count = last_seed - first_seed + 1;
  for (const Varied& one : varied) count *= one.values.size();
  return count;
}

SweepCase SweepPlan::case_at(std::size_t number) const {
  std::size_t rest = number - 1;
  const std::size_t seeds = last_seed - first_seed + 1;
  SweepCase one{number, std::vector<std::string>(varied.size()), first_seed + rest % seeds};
  rest /= seeds;
  for (std::size_t i = varied.size(); i-- > 0;) {
    const std::vector<std::string>& values = varied[i].values;
    one.values[i] = with_seed(values[rest % values.size()], one.seed);
    rest /= values.size();
  }
  return one;
}

std::vector<std::string> SweepPlan::arguments(const SweepCase& one, const std::filesystem::path& directory) const {
  std::vector<std::string> arguments{"simulate", scenario_file.string(), "--seed",     std::to_string(one.seed),
                                     "--out",    directory.string(),     "--no-report"};
  for (const std::string& text : overrides) arguments.insert(arguments.end(), {"--set", with_seed(text, one.seed)});
  for (std::size_t i = 0; i < varied.size(); ++i) {
    if (std::ranges::find(kNetwork, varied[i].key) != kNetwork.end()) {
      std::string option = "--" + varied[i].key;
      std::ranges::replace(option, '_', '-');
      arguments.insert(arguments.end(), {option, one.values[i]});
    } else if (const auto site = site_of_latency(varied[i].key)) {
      arguments.insert(arguments.end(), {"--site-latency", *site + ":" + one.values[i]});
    } else {
      arguments.insert(arguments.end(), {"--set", varied[i].key + "=" + one.values[i]});
    }
  }
  return arguments;
}

std::filesystem::path SweepFiles::result(std::size_t number) const {
  return directory / "cases" / fmt::format("{:06}.json", number);
}

std::filesystem::path SweepFiles::run(std::size_t number) const {
  return directory / "cases" / fmt::format("{:06}_run", number);
}

std::filesystem::path SweepFiles::log(std::size_t number) const {
  return directory / "cases" / fmt::format("{:06}.log", number);
}

void write_plan(const SweepPlan& plan, const SweepFiles& files) {
  Json varied = Json::array();
  for (const Varied& one : plan.varied) varied.push_back({{"key", one.key}, {"values", one.values}});
  const Json json{{"schema", "hybridtest/sweep/1"},
                  {"scenario_file", plan.scenario_file.string()},
                  {"scenario_digest", plan.scenario_digest},
                  {"overrides", plan.overrides},
                  {"varied", varied},
                  {"first_seed", plan.first_seed},
                  {"last_seed", plan.last_seed},
                  {"keeps_runs", plan.keeps_runs}};
  prepare_output_directory(files.directory / "cases");
  write_output_file(files.plan(), json.dump(1) + "\n");
}

SweepPlan read_plan(const SweepFiles& files) {
  std::ifstream stream{files.plan()};
  if (!stream) throw ConfigError{files.plan().string() + ": is not there; a folder of `hybridtest sweep` has one"};
  try {
    const Json json = Json::parse(stream);
    if (json.at("schema") != "hybridtest/sweep/1") throw ConfigError{files.plan().string() + ": of another version"};
    SweepPlan plan;
    plan.scenario_file = json.at("scenario_file").get<std::string>();
    plan.scenario_digest = json.at("scenario_digest");
    plan.overrides = json.at("overrides");
    for (const Json& one : json.at("varied")) plan.varied.push_back({one.at("key"), one.at("values")});
    plan.first_seed = json.at("first_seed");
    plan.last_seed = json.at("last_seed");
    plan.keeps_runs = json.at("keeps_runs");
    return plan;
  } catch (const Json::exception& error) {
    throw ConfigError{files.plan().string() + ": cannot be read: " + error.what()};
  }
}

}  // namespace hybridtest
