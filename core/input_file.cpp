#include "core/input_file.hpp"

#include <cerrno>
#include <fstream>
#include <system_error>

#include "core/config_error.hpp"

namespace hybridtest {

std::optional<std::string> why_unreadable(const std::filesystem::path& file) {
  std::error_code error;
  switch (std::filesystem::status(file, error).type()) {
    case std::filesystem::file_type::regular: return {};
    case std::filesystem::file_type::not_found: return "no such file";
    case std::filesystem::file_type::directory: return "it is a folder";
    case std::filesystem::file_type::fifo: return "it is a named pipe";
    case std::filesystem::file_type::socket: return "it is a socket";
    case std::filesystem::file_type::block:
    case std::filesystem::file_type::character: return "it is a device";
    default: return error ? error.message() : "it is not a regular file";
  }
}

std::string read_input_file(const std::filesystem::path& file, std::size_t bytes_max, std::string_view expected) {
  const auto refuse = [&](const std::string& why) {
    throw ConfigError{{ConfigIssue{.file = file.string(), .what = why + "; expected " + std::string{expected}}}};
  };
  if (const auto why = why_unreadable(file)) refuse("cannot be read: " + *why);
  errno = 0;
  std::ifstream stream{file, std::ios::binary};
  if (!stream) refuse("cannot be read: " + std::generic_category().message(errno == 0 ? EIO : errno));
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) refuse("cannot be read: " + error.message());
  if (size > bytes_max) refuse("larger than " + std::to_string(bytes_max >> 20U) + " MiB");
  std::string text(static_cast<std::size_t>(size), '\0');
  stream.read(text.data(), static_cast<std::streamsize>(size));
  if (stream.bad() || static_cast<std::uintmax_t>(stream.gcount()) != size) refuse("cannot be read to its end");
  return text;
}

}  // namespace hybridtest
