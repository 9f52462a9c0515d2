#pragma once

#include <vector>

#include "mechanics/laws/law.hpp"
#include "scenario/catalogue/part.hpp"

namespace hybridtest {

/// Every law that a file can name.
[[nodiscard]] const std::vector<PartType<Maker<Law>>>& laws();

[[nodiscard]] Maker<Law> read_law(config::Section section);
/// A law or `none`, which is an empty maker: a specimen without a force of its own.
[[nodiscard]] Maker<Law> read_specimen_law(config::Section section);
/// A list of laws; a single one may stand without the list.
[[nodiscard]] std::vector<Maker<Law>> read_laws(config::Section& section, std::string_view key);

[[nodiscard]] std::vector<std::unique_ptr<Law>> make_all(const std::vector<Maker<Law>>& makers);

}  // namespace hybridtest
