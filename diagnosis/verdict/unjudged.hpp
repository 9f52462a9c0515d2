#pragma once

#include <span>
#include <vector>

#include "diagnosis/recording.hpp"
#include "diagnosis/result/diagnosis_report.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// An entry, with what is missing, for every interface of the chain that `where` does not have.
/// @param dof   0-based; of recordings of the role fit.
void add_unjudged(const SiteModel& model, std::span<const Recording> recordings, std::size_t dof,
                  std::vector<report::InterfaceGap>& where);

}  // namespace hybridtest
