#include "scenario/named_file.hpp"

#include <string>
#include <system_error>

namespace hybridtest {

std::optional<std::filesystem::path> named_file(config::Section& section, std::string_view key,
                                                const std::filesystem::path& directory) {
  const std::filesystem::path written = section.text(key);
  if (written.empty()) return {};  // is reported
  const std::filesystem::path file = directory / written;
  std::error_code error;
  if (std::filesystem::exists(file, error)) return file;
  section.error(key, "there is no file " + std::filesystem::absolute(file, error).lexically_normal().string() +
                         (written.is_absolute() ? "; check the path"
                                                : "; a relative path starts at the folder of the scenario file: copy "
                                                  "the file there, or write its absolute path"));
  return {};
}

}  // namespace hybridtest
