#pragma once

#include <span>
#include <string_view>

namespace hybridtest {

/// A file that is part of the program, see hybridtest_embed_files() in cmake/HybridtestTarget.cmake.
struct EmbeddedFile {
  std::string_view name;  // without its folder
  std::string_view content;
};

}  // namespace hybridtest
