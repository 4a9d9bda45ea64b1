// A whole reflectance table from few directions: the most likely one under a basis, and how far it can be trusted.
//
// Observation k is y_k = x'_k - m'_k, the mapped reflectance (goniometry/mapping.h) less the basis' mean, both
// interpolated linearly between cells as tables are; Q' are the rows of the basis there. With x = m + Q c + rest,
// c ~ N(0, 1):
//   y = Q' c + e,  e ~ N(0, 1 / W),  1 / W_k = sigma_k^2 (w_k / (f_k w_k + epsilon))^2 + rest_k^2
//   c = (Q'' W Q' + 1)^-1 Q'' W y,   S = (Q'' W Q' + 1)^-1,   variance of x per cell = s^2 (q' S q + b rest^2)
// sigma_k: the sample's own, else `relative_noise` f_k. Where several samples share a cell's neighbourhood, rest_k is
// what they have in common; it is taken as independent, and the interval of the cell keeps it in full.
// method tikhonov is that of Nielsen et al. 2015 (and the thesis' section 2.C): W = 1, and eta over Q = V S, which is
// eta / (n - 1) in the units here; its S is taken with the same noise.
//
// A material unlike those of the basis: with prior variances a and 1 / W times b, ln a and ln b normal of the width ln
// 4 and not negative, the most likely pair (of y, c integrated out) replaces a = b = 1. b is what keeps a few precise
// observations of a strange material from being explained by wild components; rest is taken b times as well.
//
// s makes intervals honest for these very directions, region by region
// (goniometry/reconstruct/reconstruction_regions.h): every class of materials of the basis (basis.h; in a folder of
// tables each is its own) is taken out in turn, and each of its materials reconstructed by the same steps from its
// values at the same directions with simulated noise, by the mean and covariance of the others' c and the `rest` that
// the others have. What the others cannot give is in the simulated values as it is, smooth over the cells, where
// classes are models; materials of a folder, whose own share of the components cannot be told, get it as independent
// noise.
//
// Bands: red, green and blue as they are; one band serves all three. Others become three by averages over the
// wavelengths above 590 nm, between 480 and 590 nm, and below 480 nm, where nothing lies within, by the band nearest to
// 637, 545 and 453 nm; sigmas of averaged bands are averaged, as for errors that bands share.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "goniometry/basis/basis.h"
#include "goniometry/reconstruct/reconstruction_regions.h"
#include "goniometry/samples.h"
#include "io/merl.h"

namespace gonio::goniometry {

struct ReconstructOptions {
  enum class Method { map, tikhonov };
  Method method = Method::map;
  double eta = 40;               // of tikhonov
  double relative_noise = 0.02;  // of samples that state no sigma
  bool uncertainty = true;       // per cell; left out, only the table is made
  bool calibrate = true;         // s by leaving materials out
  bool energy = true;            // integrate the table
};

struct Energy {
  double most = 0;       // largest directional-hemispherical reflectance of the table
  double theta_rad = 0;  // where
  int channel = 0;
};

struct ChannelFit {
  std::vector<double> scores;  // c
  double chi2 = 0;             // of y under the basis' own variance and noise
  std::size_t observations = 0;
  double misfit = 1, excess = 1;  // roots of b and a
  double rms_ln = 0;              // of what is left of y
  double open_ln = 0;             // root of the mean variance of cells, before s
};

struct Reconstruction {
  io::MerlTable table;          // 1/sr; negative below the horizon
  io::MerlTable sigma;          // 1/sr, one standard deviation; empty without `uncertainty`
  std::vector<float> sigma_ln;  // of x, in the order of table.brdf_per_sr; 0 below the horizon
  std::array<ChannelFit, 3> channels;
  Widening widenings;   // s
  double widening = 1;  // its geometric mean over regions
  double covered = 0;   // share of left-out cells within 95 % intervals before s was applied
  Energy energy;
  std::vector<std::string> notes;  // bands, energy, reciprocity, basis, misfit: one sentence each
  std::vector<Dropped> dropped;
};

// Interval of a cell of the table that holds with the probability of +-z standard deviations of a normal variable.
struct CellInterval {
  double lower = 0, upper = 0;
};
CellInterval interval(const Reconstruction& reconstruction, std::size_t place, std::size_t band, double z = 1.96);

// Error(data) where no sample is usable or bands have no wavelengths.
Reconstruction reconstruct(const Basis& basis, const Samples& samples, const ReconstructOptions& options = {});

// Three bands of any number; see above. `notes` says how.
Samples rgb_of_bands(const Samples& samples, std::vector<std::string>& notes);
// 0 red, 1 green, 2 blue: the colour that a band of these samples goes into. One band alone: green, as all are alike.
std::size_t colour_of_band(const Samples& samples, std::size_t band);

// By the table's own interpolation (surface/merl_table.h).
Energy energy_of(const io::MerlTable& table);

}  // namespace gonio::goniometry
