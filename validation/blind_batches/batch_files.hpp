#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "validation/blind_batches/plant/blind_case.hpp"

/// What a batch looks like in files: docs/blind_batches.md.
namespace hybridtest::blind {

/// SHA-256 of a text, hexadecimal.
using Digest = std::function<std::string(std::string_view)>;

/// `case_0001` for 0.
[[nodiscard]] std::string case_name(std::size_t index);

/// The user's model; depends on the site alone.
[[nodiscard]] std::string site_yaml(const Site& site);

/// Header of names and units, one row per sample, every number equally wide, so that a file's size tells
/// nothing but its length.
[[nodiscard]] std::string recording_csv(const PlantRecording& recording, const RecordedColumns& columns,
                                        double rate_hz);

/// A case's entry in the key.
[[nodiscard]] nlohmann::ordered_json truth_json(const std::string& name, const BlindCase& blind_case);

[[nodiscard]] std::string_view name_of(TruthClass kind) noexcept;

}  // namespace hybridtest::blind
