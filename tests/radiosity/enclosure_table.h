#pragma once

#include <fstream>
#include <nlohmann/json.hpp>

#include "test_paths.h"

namespace penumbra::test {

/// Enclosures with known solutions: closed forms, and converged integral equations with their uncertainty.
inline const nlohmann::json& enclosure_table() {
  static const nlohmann::json table = [] {
    std::ifstream in(PENUMBRA_TEST_DATA "/radiosity/enclosures.json");
    return nlohmann::json::parse(in);
  }();
  return table;
}

}  // namespace penumbra::test
