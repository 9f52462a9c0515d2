#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>

#include "core/config/override.hpp"
#include "core/config/section.hpp"
#include "core/config/section_state.hpp"
#include "core/config/wording.hpp"
#include "core/config/yaml_reader.hpp"

namespace hybridtest::config {
namespace {

/// One byte more than the limit is read, to detect a file that is too large.
std::string read_file(const std::filesystem::path& file) {
  const auto fail = [&file](const std::string& why) {
    throw ConfigError{{ConfigIssue{.file = file.string(), .line = 0, .column = 0, .what = "cannot be read: " + why}}};
  };
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) fail("it is a directory");
  errno = 0;
  std::ifstream stream{file, std::ios::binary};
  if (!stream) fail(std::generic_category().message(errno));
  std::string text(kBytesMax + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad()) fail(std::generic_category().message(errno));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

std::unique_ptr<DocumentState> read_document(std::string_view text, std::string name,
                                             const std::vector<std::string>& overrides) {
  auto state = std::make_unique<DocumentState>();
  state->directory = std::filesystem::path{name}.parent_path();
  Source& source = state->sources.emplace_back();
  source.name = std::move(name);
  std::vector<Finding> findings;
  auto root = read_yaml(text, source, "", kDepthMax, findings);
  const bool is_mapping = root && root->kind == Node::Kind::mapping;
  if (root && !is_mapping)
    findings.push_back({root->place, "expected a mapping (key: value) at the top, found " + described(*root)});
  if (is_mapping) {
    state->root = std::move(*root);
    for (const std::string& assignment : overrides) {
      Source& origin = state->sources.emplace_back();
      origin.order = static_cast<int>(state->sources.size()) - 1;
      apply_override(assignment, origin, state->root, findings);
    }
  }
  for (Finding& finding : findings) state->report(std::move(finding));
  if (!is_mapping) throw ConfigError{state->config_issues()};
  state->root_section = std::make_shared<SectionState>(*state, &state->root, "", state->root.place);
  return state;
}

}  // namespace

Document Document::load(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  return Document{read_document(read_file(file), file.string(), overrides)};
}

Document Document::parse(std::string_view text, std::string name, const std::vector<std::string>& overrides) {
  return Document{read_document(text, std::move(name), overrides)};
}

Document::Document(std::unique_ptr<DocumentState> state) : state_{std::move(state)} {}
Document::Document(Document&&) noexcept = default;
Document& Document::operator=(Document&&) noexcept = default;
Document::~Document() = default;

Section Document::root() { return Section{state_->root_section}; }

std::filesystem::path Document::directory() const { return state_->directory; }

bool Document::has_errors() const { return !state_->issues.empty(); }

void Document::throw_if_errors() const {
  if (has_errors()) throw ConfigError{state_->config_issues()};
}

std::string Document::effective() const {
  std::string yaml;
  state_->root_section->write(yaml, 0);
  return yaml.empty() ? "{}\n" : yaml;
}

}  // namespace hybridtest::config
