// Any bands as red, green and blue.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "goniometry/reconstruct/reconstruction.h"

namespace gonio::goniometry {
namespace {

constexpr double green_from_m = 480e-9, red_from_m = 590e-9;
constexpr std::array<double, 3> centre_m = {637e-9, 545e-9, 453e-9};

std::size_t colour_of(double wavelength_m) {
  return wavelength_m >= red_from_m ? 0 : wavelength_m >= green_from_m ? 1 : 2;
}

bool is_rgb(const Samples& samples) {
  if (samples.bands() != 3) return false;
  const char* letters[] = {"r", "g", "b"};
  const char* words[] = {"red", "green", "blue"};
  for (std::size_t b = 0; b < 3; ++b) {
    std::string name = samples.band_name[b];
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (name != letters[b] && name != words[b]) return false;
  }
  return true;
}

// The bands that make up each colour.
std::array<std::vector<std::size_t>, 3> members_of(const Samples& samples, std::vector<std::string>& notes) {
  std::array<std::vector<std::size_t>, 3> members;
  for (std::size_t b = 0; b < samples.bands(); ++b) members[colour_of(samples.band_m[b])].push_back(b);
  const char* word[] = {"red", "green", "blue"};
  for (std::size_t c = 0; c < 3; ++c) {
    if (!members[c].empty()) {
      notes.push_back(format("%s is the mean of %zu bands.", word[c], members[c].size()));
      continue;
    }
    const auto nearest = std::ranges::min_element(
        samples.band_m, {}, [&](double wavelength_m) { return std::abs(wavelength_m - centre_m[c]); });
    members[c].push_back(static_cast<std::size_t>(nearest - samples.band_m.begin()));
    notes.push_back(format("No band is %s: the nearest, at %.0f nm, stands for it.", word[c], *nearest * 1e9));
  }
  return members;
}

}  // namespace

std::size_t colour_of_band(const Samples& samples, std::size_t band) {
  if (samples.bands() == 1) return 1;
  return is_rgb(samples) || samples.band_m.size() != samples.bands() ? std::min<std::size_t>(band, 2)
                                                                     : colour_of(samples.band_m[band]);
}

Samples rgb_of_bands(const Samples& samples, std::vector<std::string>& notes) {
  if (samples.bands() == 1) {
    notes.push_back("One band serves red, green and blue.");
    return samples;
  }
  if (is_rgb(samples)) return samples;
  if (samples.band_m.size() != samples.bands())
    throw Error(Exit::data, samples.name,
                "has " + std::to_string(samples.bands()) + " bands whose wavelengths are not known",
                "name them r, g and b, or state their wavelengths");
  const auto members = members_of(samples, notes);
  Samples out = samples;
  out.band_name = {"r", "g", "b"};
  out.band_m.assign(centre_m.begin(), centre_m.end());
  out.f.assign(3 * samples.rows(), 0);
  out.sigma.assign(samples.sigma.empty() ? 0 : 3 * samples.rows(), 0);
  for (std::size_t r = 0; r < samples.rows(); ++r)
    for (std::size_t c = 0; c < 3; ++c)
      for (const std::size_t b : members[c]) {
        const auto share = 1 / static_cast<double>(members[c].size());
        out.f[3 * r + c] += share * samples.f[r * samples.bands() + b];
        if (!out.sigma.empty()) out.sigma[3 * r + c] += share * samples.sigma[r * samples.bands() + b];
      }
  return out;
}

}  // namespace gonio::goniometry
