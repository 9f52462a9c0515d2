#include "core/config/section_state.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "core/config/wording.hpp"
#include "core/text/scalar.hpp"
#include "core/text/shown.hpp"

namespace hybridtest::config {
namespace {

/// Limit of the number of reports; limits the work on hostile input.
constexpr std::size_t kIssuesMax = 1000;

auto order_of(const Place& place) { return std::tuple{place.source->order, place.line, place.column}; }

ConfigIssue config_issue(const DocumentState::Issue& issue) {
  const Place& place = issue.finding.place;
  std::string what = issue.finding.what;
  if (issue.missing_section && !issue.missing_section->needed().empty())
    what += "; required in it: " + listed(issue.missing_section->needed());
  return {.file = place.source->name, .line = place.line, .column = place.column, .what = std::move(what)};
}

}  // namespace

SectionState::SectionState(DocumentState& document, const Node* node, std::string path, Place place)
    : document_{document}, node_{node}, path_{std::move(path)}, place_{place} {
  if (node_ == nullptr) return;
  for (const Node& child : node_->children) children_.emplace(child.key, &child);
}

const Node* SectionState::find(std::string_view key) const {
  const auto found = children_.find(key);
  return found == children_.end() ? nullptr : found->second;
}

const Node* SectionState::read(std::string_view key) {
  if (position_of_key_.try_emplace(std::string{key}, records_.size()).second)
    records_.push_back({std::string{key}, Nothing{}});
  return find(key);
}

std::shared_ptr<SectionState> SectionState::open(const Node* node, std::string path, Place place) const {
  return std::make_shared<SectionState>(document_, node, std::move(path), place);
}

void SectionState::report(const Place& place, std::string_view path, std::string_view what, Shared missing_section) {
  document_.report(found_at(place, path, what), std::move(missing_section));
}

void SectionState::report_missing(std::string_view key, std::string_view expected, Shared missing_section) {
  if (node_ != nullptr) {
    report(place_, path_of(key), "missing; expected " + std::string{expected}, std::move(missing_section));
    return;
  }
  if (std::find(needed_.begin(), needed_.end(), key) == needed_.end()) needed_.emplace_back(key);
}

bool SectionState::is_full() const noexcept { return document_.is_full(); }

void SectionState::report_unknown_keys() {
  if (node_ == nullptr) return;
  std::vector<std::string> known;
  for (const Record& record : records_) known.push_back(record.key);
  for (const Node& child : node_->children) {
    if (position_of_key_.contains(child.key) || is_full()) continue;
    report(child.key_place, path_of(shown(child.key)), "unknown key" + name_advice(child.key, known, "known here"));
  }
}

const SectionState::Value* SectionState::recorded(std::string_view key) const {
  const auto position = position_of_key_.find(std::string{key});
  return position == position_of_key_.end() ? nullptr : &records_[position->second].value;
}

SectionState::Value& SectionState::value_of(std::string_view key) {
  return records_[position_of_key_.at(std::string{key})].value;
}

void SectionState::keep(std::string_view key, Value value) {
  Value& kept = value_of(key);
  if (std::holds_alternative<Nothing>(kept)) kept = std::move(value);
}

void SectionState::record(std::string_view key, std::string yaml) { keep(key, std::move(yaml)); }

std::shared_ptr<SectionState> SectionState::recorded_section(std::string_view key) const {
  const Value* const value = recorded(key);
  const auto* const section = value == nullptr ? nullptr : std::get_if<std::shared_ptr<SectionState>>(value);
  return section == nullptr ? nullptr : *section;
}

const SectionState::Children* SectionState::recorded_sections(std::string_view key) const {
  const Value* const value = recorded(key);
  return value == nullptr ? nullptr : std::get_if<Children>(value);
}

void SectionState::record_section(std::string_view key, std::shared_ptr<SectionState> section) {
  keep(key, std::move(section));
}

void SectionState::record_sections(std::string_view key, Children sections) { keep(key, std::move(sections)); }

void SectionState::write(std::string& out, std::size_t indentation, std::string_view only) const {
  constexpr std::size_t kStep = 2;
  const std::string margin(indentation, ' ');
  for (const Record& record : records_) {
    if (std::holds_alternative<Nothing>(record.value)) continue;
    if (!only.empty() && record.key != only) continue;
    out += margin + written_text(record.key) + ':';
    if (const auto* const yaml = std::get_if<std::string>(&record.value)) {
      out += ' ' + *yaml + '\n';
    } else if (const auto* const section = std::get_if<std::shared_ptr<SectionState>>(&record.value)) {
      std::string inner;
      (*section)->write(inner, indentation + kStep);
      out += inner.empty() ? " {}\n" : '\n' + inner;
    } else {
      const auto& elements = std::get<Children>(record.value);
      out += elements.empty() ? " []\n" : "\n";
      for (const auto& element : elements) {
        std::string inner;
        element->write(inner, indentation + 2 * kStep);
        if (inner.empty()) inner = std::string(indentation + 2 * kStep, ' ') + "{}\n";
        inner[indentation + kStep] = '-';
        out += inner;
      }
    }
  }
}

bool DocumentState::is_full() const noexcept { return issues.size() >= kIssuesMax; }

bool DocumentState::report(Finding finding, std::shared_ptr<const SectionState> missing_section) {
  if (is_full()) return false;
  const Place& place = finding.place;
  const ConfigIssue rendered{
      .file = place.source->name, .line = place.line, .column = place.column, .what = finding.what};
  if (!known_issues.insert(rendered.text()).second) return false;
  issues.push_back({std::move(finding), std::move(missing_section)});
  return true;
}

std::vector<ConfigIssue> DocumentState::config_issues() const {
  std::vector<const Issue*> sorted;
  for (const Issue& issue : issues) sorted.push_back(&issue);
  std::stable_sort(sorted.begin(), sorted.end(), [](const Issue* a, const Issue* b) {
    return order_of(a->finding.place) < order_of(b->finding.place);
  });
  std::vector<ConfigIssue> result;
  for (const Issue* issue : sorted) result.push_back(config_issue(*issue));
  if (is_full())
    result.push_back({.file = sources.front().name, .line = 0, .column = 0, .what = "more errors are not shown"});
  return result;
}

}  // namespace hybridtest::config
