// Small bases and measurements of known materials for tests.
#pragma once
#include <cmath>

#include "base/random.h"
#include "goniometry/plan.h"
#include "goniometry/reconstruct/reconstruction.h"

namespace gonio::tests {

inline constexpr goniometry::Bins small_bins = {24, 12, 12};

inline std::vector<goniometry::Material> some_materials(std::size_t count) {
  return goniometry::builtin_materials({.bins = small_bins, .materials = count, .seed = 3});
}
inline goniometry::Basis basis_of(const std::vector<goniometry::Material>& materials,
                                  const goniometry::BasisOptions& options = {}) {
  return {*goniometry::tables_of(materials, small_bins), "a test's materials", options};
}

// What a table of this resolution says between its cells: its truth.
class TableTruth {
 public:
  TableTruth(const goniometry::Material& material, const goniometry::Bins& bins) : cells_(bins) {
    for (std::size_t c = 0; c < cells_.count(); ++c) {
      const auto [wo, wi] = cells_.directions(c);
      f_.push_back(material.brdf(wo, wi));
    }
  }
  Rgb cell(std::size_t c) const { return f_[c]; }
  Rgb at(Vec3 wo, Vec3 wi) const {
    const auto blend = cells_.blend(wo, wi);
    const double w = goniometry::cosine_weight(wi, wo);
    double out[3];
    for (int band = 0; band < 3; ++band) {
      double level = 0;
      for (std::size_t k = 0; k < 8; ++k)
        level += blend.share[k] * goniometry::log_level(f_[blend.cell[k]][band], cells_.weight(blend.cell[k]));
      out[band] = goniometry::of_level(level, w);
    }
    return {out[0], out[1], out[2]};
  }
  const goniometry::Cells& cells() const { return cells_; }

 private:
  goniometry::Cells cells_;
  std::vector<Rgb> f_;
};

// Relative Gaussian noise, stated.
inline goniometry::Samples measured(const TableTruth& truth, const std::vector<goniometry::PlannedPair>& pairs,
                                    double relative_noise, std::uint64_t seed) {
  goniometry::Samples samples{.name = "measured", .band_name = {"r", "g", "b"}};
  Random random(seed);
  for (const auto& pair : pairs) {
    samples.wi.push_back(pair.wi());
    samples.wo.push_back(pair.wo());
    const Rgb f = truth.at(pair.wo(), pair.wi());
    for (int band = 0; band < 3; ++band) {
      samples.f.push_back(f[band] * (1 + relative_noise * random.normal()));
      samples.sigma.push_back(f[band] * relative_noise);
    }
  }
  return samples;
}

// Of a cell's middle in the output tables.
inline std::size_t place_of(const goniometry::Cells& cells, std::size_t cell) {
  const auto [rings, tilts, turns] = cells.bins();
  for (std::size_t place = 0; place < rings * tilts * turns; ++place)
    if (cells.cell_of(place / turns / tilts, place / turns % tilts, place % turns) == cell) return place;
  return 0;
}

}  // namespace gonio::tests
