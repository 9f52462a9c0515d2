#pragma once

#include <vector>

#include "diagnosis/recording.hpp"
#include "diagnosis/result/diagnosis_report.hpp"

namespace hybridtest {

/// What the measured channels of one degree of freedom tell of their sensors by themselves.
void add_sensor_facts(const Recording& recording, std::size_t dof, report::DiagnosisReport& report);

}  // namespace hybridtest
