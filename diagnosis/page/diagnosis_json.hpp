#pragma once

#include <string>

#include "diagnosis/diagnose.hpp"

namespace hybridtest {

/// diagnosis.json, schema `hybridtest/diagnosis/1`; see docs/diagnosis.md.
[[nodiscard]] std::string diagnosis_json(const Diagnosis& diagnosis);

}  // namespace hybridtest
