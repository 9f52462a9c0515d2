#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Text for a cell of a Markdown table: a bar would end the cell.
[[nodiscard]] std::string cell(std::string_view words);

/// The first two lines of a table of parameters. @param first   head of its first column.
[[nodiscard]] std::string table_head(std::string_view first);

/// Collects what the documentation says of each parameter, one row per key.
class ParameterTable final : public ParameterArchive {
 public:
  struct Row {
    std::string key{};
    std::string unit{};
    std::string what{};
    std::string values{};
    std::string fallback{};  // `—` when the key is required
  };

  void either(const Alternative& first, const Alternative& second) override;
  /// A key that the reader of the part reads by itself, because its value is no number.
  void add(Row row) { rows_.push_back(std::move(row)); }

  [[nodiscard]] const std::vector<Row>& rows() const noexcept { return rows_; }
  /// Lines `| first | key | unit | what | values | default |`; the cell `first` in the first of them alone.
  [[nodiscard]] std::string lines(std::string first) const;

 protected:
  void number(std::string_view key, double& value, const ParameterRule& rule, bool is_required) override;
  void integer(std::string_view key, int& value, const ParameterRule& rule) override;
  void boolean(std::string_view key, bool& value, const ParameterRule& rule) override;
  /// The parameters inside are documented on their own.
  void nested(std::string_view key, std::string_view what, const Visit& visit) override;

 private:
  void add(std::string_view key, const ParameterRule& rule, std::string fallback);

  std::vector<Row> rows_;
};

}  // namespace hybridtest
