// "acceptance": figures of optical scanners.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

namespace gonio::manifest {

struct AcceptanceResult {  // "acceptance": figures after VDI/VDE 2634 part 2 of an optical scanner
  std::string quantity;    // probing-form, probing-size, sphere-distance, flatness
  std::string file, unit;
  double value = 0;                                       // worst case, as the guideline asks
  std::optional<double> bias, sigma, limit, uncertainty;  // same unit
  std::optional<std::int64_t> count, rejected;
};

}  // namespace gonio::manifest
