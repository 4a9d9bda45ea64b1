// Samples of a BRDF as a goniometer takes them: pairs of directions, the reflectance in any number of bands, its
// standard uncertainty, and which samples share what may have gone wrong.
//
// Directions are unit vectors in the sample's frame: z the normal, x the direction from which azimuths count; wi to the
// light, wo to the eye, both with z > 0. f is the BRDF in 1/sr, without a cosine. The mirror direction of wi is
// (-wi.x, -wi.y, wi.z), whatever the file's convention was. Numbers of row r and band b lie at [r * bands() + b]; f is
// NaN where a band of a row was dropped.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "geom/vector.h"

namespace gonio::goniometry {

struct Samples {
  std::string name;  // of the material or the file
  std::vector<Vec3> wi, wo;
  std::vector<std::string> band_name;  // "r", "550 nm", ""
  std::vector<double> band_m;          // wavelengths; empty where they are not known
  std::vector<double> f;
  std::vector<double> sigma;        // standard uncertainty of f; empty: not known
  std::vector<std::size_t> series;  // from 0: rows of one scan, of one light pose; held out together
  std::vector<std::string> place;   // "scan.csv:17", "images/12": for messages
  std::size_t rows() const { return wi.size(); }
  std::size_t bands() const { return band_name.size(); }
};

// What did not become a sample, and why: "saturated", "below the horizon", ...
struct Dropped {
  std::string place, reason;
};

}  // namespace gonio::goniometry
