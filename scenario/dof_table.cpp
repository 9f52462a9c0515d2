#include "scenario/dof_table.hpp"

#include <algorithm>
#include <utility>

#include "core/config_error.hpp"
#include "core/input_file.hpp"
#include "core/text/shown.hpp"
#include "scenario/plain_name.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kTableBytesMax = std::size_t{64} << 20U;
constexpr std::size_t kTableIssuesMax = 20;
constexpr const char* kHeader = "expected the header node,direction or node,direction,name";

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

std::vector<std::string_view> cells(std::string_view line) {
  std::vector<std::string_view> found;
  while (true) {
    const std::size_t comma = line.find(',');
    found.push_back(without_blanks(line.substr(0, comma)));
    if (comma == std::string_view::npos) return found;
    line.remove_prefix(comma + 1);
  }
}

/// Position in kDirections of a name or a number.
std::optional<std::size_t> direction_of(std::string_view text) {
  const auto* const named = std::ranges::find(kDirections, text);
  if (named != kDirections.end()) return static_cast<std::size_t>(named - kDirections.begin());
  if (text.size() == 1 && text.front() >= '1' && text.front() <= '6') return static_cast<std::size_t>(text[0] - '1');
  return std::nullopt;
}

std::string place_of(std::string_view node, std::size_t direction) {
  return std::string{node} + "." + std::string{kDirections.at(direction)};
}

/// `*` any letters, `?` one.
bool matches(std::string_view pattern, std::string_view text) {
  std::size_t at = 0;
  std::size_t in_text = 0;
  std::size_t star = std::string_view::npos;
  std::size_t resume = 0;
  while (in_text < text.size()) {
    if (at < pattern.size() && pattern[at] == '*') {
      star = at++;
      resume = in_text;
    } else if (at < pattern.size() && (pattern[at] == '?' || pattern[at] == text[in_text])) {
      ++at;
      ++in_text;
    } else if (star != std::string_view::npos) {
      at = star + 1;
      in_text = ++resume;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', at) == std::string_view::npos;
}

/// A row of the file.
struct TableRow {
  std::string name;
  std::string place;
  std::size_t direction = 0;
};

/// The lines of a table of degrees of freedom, and what is wrong with them.
class TableReader {
 public:
  TableReader(std::string_view text, const std::string& file) : left_{text}, file_{file} {}

  [[nodiscard]] std::vector<TableRow> read() {
    read_header();
    std::vector<TableRow> rows;
    while (next_line()) {
      if (auto row = read_row()) rows.push_back(std::move(*row));
    }
    if (rows.empty() && issues_.empty()) report("the file ends here; expected a row for each degree of freedom");
    if (!issues_.empty()) throw ConfigError{std::move(issues_)};
    return rows;
  }

 private:
  bool next_line() {
    while (!left_.empty()) {
      const std::size_t length = std::min(left_.find('\n'), left_.size());
      line_ = without_blanks(left_.substr(0, length));
      left_.remove_prefix(std::min(length + 1, left_.size()));
      ++number_;
      if (!line_.empty() && line_.front() != '#') return true;
    }
    return false;
  }

  void report(std::string what) {
    issues_.push_back({.file = file_, .line = number_, .column = 0, .what = std::move(what)});
    if (issues_.size() == kTableIssuesMax) throw ConfigError{std::move(issues_)};
  }

  void read_header() {
    if (next_line()) {
      const std::vector<std::string_view> header = cells(line_);
      columns_ = header.size();
      const std::vector<std::string_view> known{"node", "direction", "name"};
      if ((columns_ == 2 || columns_ == 3) && std::equal(header.begin(), header.end(), known.begin())) return;
    }
    report("found '" + shown(line_) + "'; " + kHeader);
    throw ConfigError{std::move(issues_)};
  }

  std::optional<TableRow> read_row() {
    const std::vector<std::string_view> cell = cells(line_);
    if (cell.size() != columns_) {
      report("found " + std::to_string(cell.size()) + " columns; expected " + std::to_string(columns_) +
             " as in the header");
      return std::nullopt;
    }
    const std::size_t issues_before = issues_.size();
    const std::optional<std::size_t> direction = direction_of(cell[1]);
    if (!direction) {
      report("'" + shown(cell[1]) + "' is no direction; expected x, y, z, rx, ry, rz or a number from 1 to 6");
    }
    require_name(cell[0], "node");
    if (cell[0].find('.') != std::string_view::npos) {
      report("the node '" + shown(cell[0]) + "' has a '.'; expected a node without, so that node.direction is clear");
    }
    const bool has_name = columns_ == 3 && !cell[2].empty();
    if (has_name) require_name(cell[2], "name");
    if (issues_.size() != issues_before) return std::nullopt;
    const std::string place = place_of(cell[0], *direction);
    TableRow row{.name = has_name ? std::string{cell[2]} : place, .place = place, .direction = *direction};
    enter(row.place, "node and direction");
    if (row.name != row.place) enter(row.name, "the name");
    return row;
  }

  void require_name(std::string_view text, const std::string& what) {
    if (is_plain_name(text) && text.size() <= kDofNameLongest) return;
    report("'" + shown(text) + "' does not serve as a " + what + "; expected at most " +
           std::to_string(kDofNameLongest) + " " + std::string{kPlainNameRule});
  }

  void enter(const std::string& key, const std::string& what) {
    const auto [entry, is_new] = lines_.try_emplace(key, number_);
    if (is_new) return;
    report(what + " '" + key + "' was given in line " + std::to_string(entry->second) +
           " already; expected each degree of freedom once");
  }

  std::string_view left_;
  const std::string& file_;
  std::string_view line_;
  int number_ = 0;
  std::size_t columns_ = 0;
  std::unordered_map<std::string, int> lines_;
  std::vector<ConfigIssue> issues_;
};

/// `114.x` of the text `node 114 dof 1`.
std::optional<std::string> place_in_words(std::string_view text) {
  std::vector<std::string_view> words;
  while (!(text = without_blanks(text)).empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    words.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  if (words.size() != 4 || words[0] != "node" || words[2] != "dof") return std::nullopt;
  const std::optional<std::size_t> direction = direction_of(words[3]);
  if (!direction) return std::nullopt;
  return place_of(words[1], *direction);
}

}  // namespace

DofTable::DofTable(std::vector<std::string> names) : names_{std::move(names)} {
  for (std::size_t row = 0; row < names_.size(); ++row) enter(static_cast<int>(row));
}

void DofTable::enter(int row) {
  rows_.try_emplace(names_[static_cast<std::size_t>(row)], row);
  if (has_directions()) rows_.try_emplace(places_[static_cast<std::size_t>(row)], row);
}

DofTable DofTable::parse(std::string_view text, const std::string& file) {
  DofTable table;
  for (TableRow& row : TableReader{text, file}.read()) {
    table.names_.push_back(std::move(row.name));
    table.places_.push_back(std::move(row.place));
    table.directions_.push_back(row.direction);
    table.enter(static_cast<int>(table.size()) - 1);
  }
  return table;
}

DofTable DofTable::read(const std::filesystem::path& file) {
  return parse(read_input_file(file, kTableBytesMax, "a table of degrees of freedom"), file.string());
}

std::vector<std::string> DofTable::keys_of(std::string_view address) const {
  std::vector<std::string> keys{std::string{address}};
  if (const auto place = place_in_words(address)) keys.push_back(*place);
  const std::size_t point = address.rfind('.');
  if (point == std::string_view::npos) return keys;
  const std::optional<std::size_t> direction = direction_of(address.substr(point + 1));
  if (direction && has_directions()) keys.push_back(place_of(address.substr(0, point), *direction));
  return keys;
}

std::optional<int> DofTable::find(std::string_view address) const {
  for (const std::string& key : keys_of(address)) {
    if (const auto found = rows_.find(key); found != rows_.end()) return found->second;
  }
  return std::nullopt;
}

DofTable DofTable::only(const std::vector<Eigen::Index>& kept, const std::string& why_gone) const {
  DofTable table;
  for (const Eigen::Index kept_row : kept) {
    const auto row = static_cast<std::size_t>(kept_row);
    table.names_.push_back(names_[row]);
    if (has_directions()) {
      table.places_.push_back(places_[row]);
      table.directions_.push_back(directions_[row]);
    }
    table.enter(static_cast<int>(table.size()) - 1);
  }
  table.gone_ = gone_;
  for (const auto& [key, row] : rows_) {
    if (!table.rows_.contains(key)) table.gone_.try_emplace(key, why_gone);
  }
  return table;
}

std::string DofTable::why_gone(std::string_view address) const {
  for (const std::string& key : keys_of(address)) {
    if (const auto found = gone_.find(key); found != gone_.end()) return found->second;
  }
  return {};
}

std::vector<int> DofTable::matching(std::string_view pattern) const {
  if (const auto row = find(pattern)) return {*row};
  std::vector<int> rows;
  for (std::size_t row = 0; row < size(); ++row) {
    const bool by_place = has_directions() && matches(pattern, places_[row]);
    if (by_place || matches(pattern, names_[row])) rows.push_back(static_cast<int>(row));
  }
  return rows;
}

std::vector<int> DofTable::in_direction(std::size_t direction) const {
  std::vector<int> rows;
  for (std::size_t row = 0; row < directions_.size(); ++row) {
    if (directions_[row] == direction) rows.push_back(static_cast<int>(row));
  }
  return rows;
}

}  // namespace hybridtest
