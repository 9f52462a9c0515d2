#include "core/input_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <string>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

using ::testing::Optional;
using ::testing::ThrowsMessage;

class InputFile : public ::testing::Test {
 protected:
  InputFile() { std::filesystem::create_directories(folder_); }
  ~InputFile() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::filesystem::path path(const char* name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_ =
      std::filesystem::path{::testing::TempDir()} /
      (std::string{"input_file_"} + ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(InputFile, ReadsEveryByteUpToTheLimit) {
  const std::string text{"a\0\r\n\xFF", 5};
  std::ofstream{path("a"), std::ios::binary} << text;
  EXPECT_EQ(read_input_file(path("a"), 5, "a text"), text);
  EXPECT_FALSE(why_unreadable(path("a")));
  EXPECT_THAT([&] { static_cast<void>(read_input_file(path("a"), 4, "a text")); }, ::testing::Throws<ConfigError>());
}

TEST_F(InputFile, SaysWhatAnUnreadableFileIs) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_THAT(why_unreadable(path("pipe")), Optional(std::string{"it is a named pipe"}));
  EXPECT_THAT(why_unreadable(path("gone")), Optional(std::string{"no such file"}));
  EXPECT_THAT(why_unreadable(path("")), Optional(std::string{"it is a folder"}));
  EXPECT_THAT(why_unreadable("/dev/zero"), Optional(std::string{"it is a device"}));
  EXPECT_THAT(
      [&] { static_cast<void>(read_input_file(path("pipe"), 4, "a text")); },
      ThrowsMessage<ConfigError>(path("pipe").string() + ": cannot be read: it is a named pipe; expected a text"));
}

TEST_F(InputFile, NamesTheLimitOfALargerFile) {
  std::ofstream{path("large")} << "x";
  std::filesystem::resize_file(path("large"), (std::size_t{4} << 20U) + 1);
  EXPECT_THAT([&] { static_cast<void>(read_input_file(path("large"), std::size_t{4} << 20U, "a text")); },
              ThrowsMessage<ConfigError>(path("large").string() + ": larger than 4 MiB; expected a text"));
}

}  // namespace
}  // namespace hybridtest
