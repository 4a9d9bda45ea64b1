// What `relief` makes: reliefs of noise, ridges and waves as its command line describes them, and the numbers that they
// were made from, as "design" of the manifest's reliefs says them.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "cli/program.h"
#include "io/height_map.h"
#include "relief/ground_noise.h"
#include "relief/ridges.h"

namespace gonio::tools::relief {

struct Made {
  gonio::relief::Relief relief;
  std::map<std::string, std::vector<double>> design;
};

// Error(usage) at the option that is missing or does not fit.
gonio::relief::RidgeShape ridge_asked(const cli::Invocation& call);
gonio::relief::NoiseField noise_asked(const cli::Invocation& call);
Made made(const cli::Invocation& call);
// Noise of a fitted form, as large as the map.
Made noise_like(const gonio::relief::GroundNoise& ground, const io::HeightMap& map, std::uint64_t seed, bool periodic);

}  // namespace gonio::tools::relief
