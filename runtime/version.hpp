#pragma once

#include <string_view>

namespace hybridtest {

/// Version and commit of this build, as `--version` prints them and recordings keep them: "0.1.0 (commit
/// 1a2b3c4d5e6f)". The commit ends in "-dirty" when files under version control were changed, and is "unknown" outside
/// a git checkout.
[[nodiscard]] std::string_view software_version() noexcept;

}  // namespace hybridtest
