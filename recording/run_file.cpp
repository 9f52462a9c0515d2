#include "recording/run_file.hpp"

#include <array>
#include <charconv>

namespace hybridtest {
namespace {

constexpr std::array<Role, 4> kRoles{Role::coordinator, Role::numerical_substructure, Role::experimental_site,
                                     Role::operator_tool};

}  // namespace

std::string_view name(Role role) noexcept {
  switch (role) {
    case Role::coordinator: return "coordinator";
    case Role::numerical_substructure: return "numerical_substructure";
    case Role::experimental_site: return "experimental_site";
    case Role::operator_tool: return "operator_tool";
  }
  return "unknown";
}

Role role_from_name(std::string_view text) noexcept {
  for (const Role role : kRoles) {
    if (name(role) == text) return role;
  }
  return Role::operator_tool;
}

std::string hex(const ScenarioDigest& digest) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : digest) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 0xFU];
  }
  return text;
}

ScenarioDigest digest_from_hex(std::string_view text) noexcept {
  ScenarioDigest digest{};
  if (text.size() != 2 * digest.size()) return {};
  for (std::size_t i = 0; i < digest.size(); ++i) {
    const char* first = text.data() + 2 * i;
    const auto [end, error] = std::from_chars(first, first + 2, digest[i], 16);
    if (error != std::errc{} || end != first + 2) return {};
  }
  return digest;
}

}  // namespace hybridtest
