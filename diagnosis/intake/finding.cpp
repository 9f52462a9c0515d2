#include "diagnosis/intake/finding.hpp"

#include <algorithm>

#include "core/text/shown.hpp"

namespace hybridtest {

std::string IntakeFinding::text(const std::string& file) const {
  std::string text = file;
  if (row > 0) text += ":" + std::to_string(row);
  text += ": ";
  if (!column.empty()) text += "column '" + shown(column) + "': ";
  if (!value.empty()) text += "'" + shown(value) + "': ";
  text += what;
  if (more == 1) text += " (and in row " + std::to_string(last_row) + ")";
  if (more > 1) text += " (and in " + std::to_string(more) + " more rows, the last " + std::to_string(last_row) + ")";
  return text;
}

void FindingList::add(std::size_t row, const std::string& column, const std::string& value, const std::string& what) {
  const auto same = std::ranges::find_if(findings_, [&](const IntakeFinding& finding) {
    return row > 0 && finding.row > 0 && finding.column == column && finding.what == what;
  });
  if (same != findings_.end()) {
    ++same->more;
    same->last_row = row;
    return;
  }
  if (findings_.size() == kMostListed) {
    ++left_out_;
    return;
  }
  findings_.push_back({.row = row, .column = column, .value = value, .what = what, .more = 0, .last_row = row});
}

std::vector<IntakeFinding> FindingList::sorted() const {
  std::vector<IntakeFinding> findings = findings_;
  std::ranges::stable_sort(findings, {}, &IntakeFinding::row);
  if (left_out_ > 0) {
    findings.emplace_back();
    findings.back().what = "and " + std::to_string(left_out_) + " more findings";
  }
  return findings;
}

}  // namespace hybridtest
