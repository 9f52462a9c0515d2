#include "core/config/section.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "core/assert.hpp"
#include "core/config/section_state.hpp"
#include "core/config/value_reader.hpp"
#include "core/config/wording.hpp"
#include "core/text/scalar.hpp"
#include "core/text/shown.hpp"

namespace hybridtest::config {
namespace {

std::string written_list(const std::vector<std::string>& entries) {
  std::string yaml = "[";
  for (const std::string& entry : entries) yaml += (yaml.size() > 1 ? ", " : "") + entry;
  return yaml + ']';
}

template <class Vector>
std::string written_numbers(const Vector& numbers) {
  std::vector<std::string> entries;
  for (Eigen::Index i = 0; i < numbers.size(); ++i) entries.push_back(written_number(numbers[i]));
  return written_list(entries);
}

/// `a list of 2 entries, each a number`.
std::string expected_list(std::size_t size, std::string_view entry) {
  std::string text = size == 0 ? "a list" : "a list of " + std::to_string(size) + (size == 1 ? " entry" : " entries");
  text += ", each ";
  text += entry;
  return text;
}

/// The list under a key if it has that many entries (0: at least one), otherwise a report and null.
const Node* read_list(SectionState& state, std::string_view key, std::size_t size, std::string_view expected) {
  const Node* const node = state.read(key);
  if (node == nullptr) {
    state.report_missing(key, expected);
    return nullptr;
  }
  const std::string path = state.path_of(key);
  if (!ValueReader{state}.is(Node::Kind::sequence, *node, path, expected)) return nullptr;
  const std::size_t count = node->children.size();
  if (size == 0 ? count > 0 : count == size) return node;
  std::string what = "expected ";
  what += expected;
  what += count == 0 ? ", found an empty list" : ", found a list of " + std::to_string(count);
  state.report(node->place, path, what);
  return nullptr;
}

std::string expected_choice(const std::vector<std::string>& choices) { return "one of " + listed(choices); }

void report_unknown_choice(SectionState& state, const Node& node, std::string_view path,
                           const std::vector<std::string>& choices) {
  state.report(node.place, path,
               "unknown value '" + shown(node.text) + "'" + name_advice(node.text, choices, "choices"));
}

/// Appends one row of a matrix. @param columns   entries expected.
bool read_row(SectionState& state, const Node& row, std::string_view path, std::size_t columns,
              std::vector<double>& values) {
  ValueReader reader{state};
  const std::string expected = expected_list(columns, expected_number(kAnyNumber));
  if (!reader.is(Node::Kind::sequence, row, path, expected)) return false;
  bool is_good = row.children.size() == columns;
  if (!is_good)
    state.report(row.place, path, "expected " + expected + ", found a list of " + std::to_string(row.children.size()));
  for (std::size_t j = 0; j < row.children.size(); ++j) {
    const auto value = reader.number(row.children[j], indexed_path(path, j), kAnyNumber);
    is_good = is_good && value;
    values.push_back(value.value_or(0.0));
  }
  return is_good;
}

/// The section of a node, or a report and an empty section.
std::shared_ptr<SectionState> open_child(SectionState& state, std::string_view key, const Node* node) {
  constexpr const char* kExpected = "a mapping";
  const std::string path = state.path_of(key);
  if (node != nullptr && node->kind == Node::Kind::mapping) return state.open(node, path, node->place);
  auto missing = state.open(nullptr, path, node != nullptr ? node->place : state.place());
  if (node == nullptr) {
    state.report_missing(key, kExpected, missing);
  } else if (node->kind != Node::Kind::refused) {
    state.report(node->place, path, std::string{"expected "} + kExpected + ", found " + described(*node), missing);
  }
  return missing;
}

SectionState::Children open_children(SectionState& state, std::string_view key, bool or_single) {
  constexpr std::string_view kExpected = "a list of mappings";
  const Node* const node = state.read(key);
  const std::string path = state.path_of(key);
  if (node == nullptr) {
    state.report_missing(key, kExpected);
    return {};
  }
  if (or_single && node->kind == Node::Kind::mapping) return {state.open(node, path, node->place)};
  ValueReader reader{state};
  if (!reader.is(Node::Kind::sequence, *node, path, kExpected)) return {};
  SectionState::Children children;
  for (std::size_t i = 0; i < node->children.size(); ++i) {
    const Node& child = node->children[i];
    const std::string child_path = indexed_path(path, i);
    if (reader.is(Node::Kind::mapping, child, child_path, "a mapping"))
      children.push_back(state.open(&child, child_path, child.place));
  }
  return children;
}

void report_unknown_names(SectionState& state, const Node& mapping, std::string_view path,
                          const std::vector<std::string>& names) {
  const std::unordered_set<std::string> known{names.begin(), names.end()};
  for (const Node& child : mapping.children) {
    if (known.contains(child.key) || state.is_full()) continue;
    state.report(child.key_place, joined_path(path, shown(child.key)),
                 "unknown name" + name_advice(child.key, names, "known here"));
  }
}

}  // namespace

bool Section::has(std::string_view key) const { return state_->find(key) != nullptr; }

bool Section::has_optional(std::string_view key) { return state_->read(key) != nullptr; }

bool Section::has_mapping(std::string_view key) const {
  const Node* const node = state_->find(key);
  return node != nullptr && node->kind == Node::Kind::mapping;
}

std::string Section::path() const { return state_->path(); }

double Section::number(std::string_view key, Range range, std::optional<double> fallback) {
  const Node* const node = state_->read(key);
  double value = fallback.value_or(usable(range));
  if (node != nullptr) {
    value = ValueReader{*state_}.number(*node, state_->path_of(key), range).value_or(value);
  } else if (!fallback) {
    state_->report_missing(key, expected_number(range));
  } else if (std::isfinite(value) && !contains(range, value)) {
    // A default may depend on other values, so the user must correct this too.
    state_->report_missing(key, expected_number(range) + ", the default is " + written_number(value));
  }
  if (std::isfinite(value)) state_->record(key, written_number(value));
  return value;
}

bool Section::reads_off(std::string_view key) {
  constexpr const char* kOff = "off";
  const Node* const node = state_->find(key);
  if (node == nullptr || node->kind != Node::Kind::scalar || node->text != kOff) return false;
  static_cast<void>(state_->read(key));
  state_->record(key, kOff);
  return true;
}

std::int64_t Section::integer(std::string_view key, std::int64_t low, std::int64_t high,
                              std::optional<std::int64_t> fallback) {
  const Node* const node = state_->read(key);
  std::int64_t value = fallback.value_or(usable(low, high));
  if (node != nullptr) {
    value = ValueReader{*state_}.integer(*node, state_->path_of(key), low, high).value_or(value);
  } else if (!fallback) {
    state_->report_missing(key, expected_integer(low, high));
  } else if (value < low || value > high) {
    state_->report_missing(key, expected_integer(low, high) + ", the default is " + written_integer(value));
  }
  state_->record(key, written_integer(value));
  return value;
}

bool Section::boolean(std::string_view key, std::optional<bool> fallback) {
  const Node* const node = state_->read(key);
  bool value = fallback.value_or(false);
  if (node != nullptr) {
    value = ValueReader{*state_}.boolean(*node, state_->path_of(key)).value_or(value);
  } else if (!fallback) {
    state_->report_missing(key, "true or false");
  }
  state_->record(key, written_boolean(value));
  return value;
}

std::string Section::text(std::string_view key, std::optional<std::string> fallback) {
  const Node* const node = state_->read(key);
  std::string value = fallback.value_or("");
  if (node != nullptr) {
    const auto written = ValueReader{*state_}.text(*node, state_->path_of(key), "a text");
    if (written && written->empty() && !fallback) {
      state_->report(node->place, state_->path_of(key), "expected a text, found an empty one");
    }
    value = written.value_or(value);
  } else if (!fallback) {
    state_->report_missing(key, "a text");
  }
  state_->record(key, written_text(value));
  return value;
}

std::size_t Section::choice(std::string_view key, const std::vector<std::string>& choices,
                            std::optional<std::string> fallback) {
  HYBRIDTEST_ASSERT(!choices.empty());
  const auto position = [&choices](const std::string& name) {
    return static_cast<std::size_t>(std::find(choices.begin(), choices.end(), name) - choices.begin());
  };
  std::size_t chosen = fallback ? position(*fallback) : 0;
  HYBRIDTEST_ASSERT(chosen < choices.size());
  const Node* const node = state_->read(key);
  const std::string path = state_->path_of(key);
  if (node == nullptr) {
    if (!fallback) state_->report_missing(key, expected_choice(choices));
  } else if (ValueReader{*state_}.is(Node::Kind::scalar, *node, path, expected_choice(choices))) {
    const std::size_t found = position(node->text);
    if (found < choices.size()) {
      chosen = found;
    } else {
      report_unknown_choice(*state_, *node, path, choices);
    }
  }
  state_->record(key, written_text(choices[chosen]));
  return chosen;
}

Eigen::VectorXd Section::numbers(std::string_view key, std::size_t size, Range range) {
  const Node* const node = read_list(*state_, key, size, expected_list(size, expected_number(range)));
  const std::size_t count = node != nullptr ? node->children.size() : std::max<std::size_t>(size, 1);
  Eigen::VectorXd values = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(count), usable(range));
  ValueReader reader{*state_};
  for (std::size_t i = 0; node != nullptr && i < count; ++i) {
    const auto value = reader.number(node->children[i], indexed_path(state_->path_of(key), i), range);
    if (value) values[static_cast<Eigen::Index>(i)] = *value;
  }
  state_->record(key, written_numbers(values));
  return values;
}

std::vector<std::int64_t> Section::integers(std::string_view key, std::int64_t low, std::int64_t high) {
  const Node* const node = read_list(*state_, key, 0, expected_list(0, expected_integer(low, high)));
  std::vector<std::int64_t> values(node != nullptr ? node->children.size() : 1, usable(low, high));
  ValueReader reader{*state_};
  for (std::size_t i = 0; node != nullptr && i < values.size(); ++i) {
    const auto value = reader.integer(node->children[i], indexed_path(state_->path_of(key), i), low, high);
    values[i] = value.value_or(values[i]);
  }
  std::vector<std::string> entries;
  for (const std::int64_t value : values) entries.push_back(written_integer(value));
  state_->record(key, written_list(entries));
  return values;
}

std::vector<std::string> Section::names(std::string_view key) {
  constexpr std::string_view kExpected = "a name";
  const Node* const node = read_list(*state_, key, 0, expected_list(0, kExpected));
  std::vector<std::string> values;
  std::unordered_set<std::string> taken;
  ValueReader reader{*state_};
  for (std::size_t i = 0; node != nullptr && i < node->children.size(); ++i) {
    const Node& child = node->children[i];
    const std::string path = indexed_path(state_->path_of(key), i);
    const auto value = reader.text(child, path, kExpected);
    if (!value) continue;
    if (value->empty()) {
      state_->report(child.place, path, "expected a name, found an empty text");
    } else if (!taken.insert(*value).second) {
      state_->report(child.place, path, "the name '" + shown(*value) + "' occurs twice in this list");
    } else {
      values.push_back(*value);
    }
  }
  std::vector<std::string> entries;
  for (const std::string& value : values) entries.push_back(written_text(value));
  state_->record(key, written_list(entries));
  return values;
}

Eigen::VectorXd Section::numbers_by_name(std::string_view key, const std::vector<std::string>& names, Range range) {
  const std::string expected = "a mapping from each of " + listed(names) + " to " + expected_number(range);
  const Node* const node = state_->read(key);
  const std::string path = state_->path_of(key);
  Eigen::VectorXd values = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(names.size()), usable(range));
  ValueReader reader{*state_};
  if (node == nullptr) {
    state_->report_missing(key, expected);
  } else if (reader.is(Node::Kind::mapping, *node, path, expected)) {
    report_unknown_names(*state_, *node, path, names);
    std::unordered_map<std::string_view, const Node*> children;
    for (const Node& child : node->children) children.emplace(child.key, &child);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto child = children.find(names[i]);
      const std::string name_path = joined_path(path, shown(names[i]));
      if (child == children.end()) {
        state_->report(node->place, name_path, "missing; expected " + expected_number(range));
      } else if (const auto value = reader.number(*child->second, name_path, range)) {
        values[static_cast<Eigen::Index>(i)] = *value;
      }
    }
  }
  std::string yaml = "{";
  for (std::size_t i = 0; i < names.size(); ++i)
    yaml += (i > 0 ? ", " : "") + written_text(names[i]) + ": " + written_number(values[static_cast<Eigen::Index>(i)]);
  state_->record(key, yaml + '}');
  return values;
}

Eigen::MatrixXd Section::matrix(std::string_view key, std::size_t rows, std::size_t columns) {
  const Node* const node = read_list(*state_, key, rows, expected_list(rows, "a row of numbers"));
  const std::size_t row_count = node != nullptr ? node->children.size() : 0;
  const std::size_t first_row = node != nullptr ? node->children.front().children.size() : 0;
  const std::size_t column_count = columns > 0 ? columns : std::max<std::size_t>(first_row, 1);
  std::vector<double> entries;
  bool is_good = node != nullptr;
  for (std::size_t i = 0; i < row_count; ++i) {
    const std::string path = indexed_path(state_->path_of(key), i);
    if (!read_row(*state_, node->children[i], path, column_count, entries)) is_good = false;
  }
  const auto at_least_one = [](std::size_t count) {
    return static_cast<Eigen::Index>(std::max<std::size_t>(count, 1));
  };
  Eigen::MatrixXd values = Eigen::MatrixXd::Identity(at_least_one(rows), at_least_one(columns));
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  if (is_good)
    values = Eigen::Map<const RowMajor>(entries.data(), static_cast<Eigen::Index>(row_count),
                                        static_cast<Eigen::Index>(column_count));
  std::vector<std::string> written_rows;
  for (Eigen::Index i = 0; i < values.rows(); ++i) written_rows.push_back(written_numbers(values.row(i)));
  state_->record(key, written_list(written_rows));
  return values;
}

std::vector<std::string> Section::keys() const {
  std::vector<std::string> keys;
  if (state_->node() == nullptr) return keys;
  for (const Node& child : state_->node()->children) keys.push_back(child.key);
  return keys;
}

Section Section::section(std::string_view key) {
  if (auto recorded = state_->recorded_section(key)) return Section{std::move(recorded)};
  const Node* const node = state_->read(key);
  auto section = open_child(*state_, key, node);
  state_->record_section(key, section);
  return Section{std::move(section)};
}

Section Section::section_or_empty(std::string_view key) {
  if (auto recorded = state_->recorded_section(key)) return Section{std::move(recorded)};
  const Node* const node = state_->read(key);
  auto section =
      node == nullptr ? state_->open(nullptr, state_->path_of(key), state_->place()) : open_child(*state_, key, node);
  state_->record_section(key, section);
  return Section{std::move(section)};
}

std::optional<Section> Section::optional_section(std::string_view key) {
  const Node* const node = state_->read(key);
  if (node == nullptr) return std::nullopt;
  if (!ValueReader{*state_}.is(Node::Kind::mapping, *node, state_->path_of(key), "a mapping")) return std::nullopt;
  return section(key);
}

std::vector<Section> Section::sections(std::string_view key, bool or_single) {
  if (state_->recorded_sections(key) == nullptr) state_->record_sections(key, open_children(*state_, key, or_single));
  std::vector<Section> sections;
  if (const auto* const recorded = state_->recorded_sections(key))
    for (const auto& section : *recorded) sections.push_back(Section{section});
  return sections;
}

std::vector<Section> Section::sections_or_empty(std::string_view key) {
  if (state_->recorded_sections(key) == nullptr && state_->read(key) == nullptr) {
    state_->record_sections(key, {state_->open(nullptr, state_->path_of(key), state_->place())});
  }
  return sections(key, true);
}

void Section::error(std::string_view key, std::string what) {
  const Node* const node = key.empty() ? nullptr : state_->find(key);
  const std::string path = key.empty() ? state_->path() : state_->path_of(key);
  // A key that an override replaced is still in the file; its old value is not used.
  const bool at_key = node != nullptr && !node->place.source->is_override;
  state_->report(at_key ? node->key_place : node != nullptr ? node->place : state_->place(), path, what);
}

std::string Section::effective(std::string_view key) const {
  std::string yaml;
  state_->write(yaml, 0, key);
  return yaml;
}

void Section::finish() { state_->report_unknown_keys(); }

}  // namespace hybridtest::config
