#include "validation/studies/output_file.hpp"

#include <fstream>
#include <system_error>

#include "core/config_error.hpp"

namespace hybridtest {

void prepare_output_directory(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) throw ConfigError{"--out " + directory.string() + ": cannot create this directory: " + error.message()};
}

void write_output_file(const std::filesystem::path& file, std::string_view text) {
  std::ofstream out{file, std::ios::binary | std::ios::trunc};
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.flush();
  if (!out)
    throw ConfigError{file.string() +
                      ": cannot be written; check that the directory is writable and the disk is not full"};
}

}  // namespace hybridtest
