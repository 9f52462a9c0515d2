#pragma once

#include <string>
#include <vector>

#include "validation/blind_batches/plant/blind_case.hpp"

namespace hybridtest::blind {

/// A possible effect at a site, and the random choice of its parameters.
struct CatalogueEntry {
  std::string interface;
  std::string name;
  bool (*fits)(const CaseSetting& setting);  // to this site, and visible in these columns
  /// @param amount   about the share of the signal that the effect makes up.
  Parameters (*draw)(RandomStream& random, const CaseSetting& setting, double amount);
};

/// A number of the user's model that is wrong.
[[nodiscard]] const std::vector<CatalogueEntry>& wrong_numbers();
/// The effects of the library, by their names there.
[[nodiscard]] const std::vector<CatalogueEntry>& named_effects();
/// Effects that are not in the library; the plant has its own names for them.
[[nodiscard]] const std::vector<CatalogueEntry>& foreign_effects();

/// Those of a catalogue that fit.
[[nodiscard]] std::vector<CatalogueEntry> fitting(const std::vector<CatalogueEntry>& catalogue,
                                                  const CaseSetting& setting);

}  // namespace hybridtest::blind
