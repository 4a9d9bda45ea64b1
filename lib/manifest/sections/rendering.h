// "renderings": pictures that were simulated.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gonio::manifest {

struct Rendering {  // "renderings"
  std::string image, file;
  std::optional<int> spp;
  std::optional<std::uint64_t> seed;
  std::vector<int> samples{};                  // [A, B]: the share of samples A to B - 1 of each pixel; left out: all
  std::optional<double> relative_error{};      // estimated, of the mean pixel
  std::vector<double> wavelengths_m{};         // spectral renderings: centres of the bins
  std::map<std::string, std::string> files{};  // further pictures by kind: "stokes", "mosaic", ... -> file id
};

}  // namespace gonio::manifest
