#include <utility>

#include "core/config/override.hpp"
#include "core/config/section.hpp"
#include "core/config/section_state.hpp"
#include "core/config/wording.hpp"
#include "core/config/yaml_reader.hpp"
#include "core/input_file.hpp"

namespace hybridtest::config {
namespace {

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
  const std::string text = read_input_file(file, kBytesMax, "a configuration file (YAML)");
  return Document{read_document(text, file.string(), overrides)};
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
