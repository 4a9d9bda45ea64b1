// Forward model of the tiles' spectra:
//   S(f) = exp(level_t) S0(|f| exp(-(a0 cos 2 phi + a45 sin 2 phi)))                 a surface, rougher along one axis
//        + gain A^2 sum_k q_k W(f - k f_g)^2,  f_g = (cos az, sin az) / period       surface.micro-ridges, k = 1, 2,
//        3
//        + R^2 W_x(fx)^2 (2 n / 3) dx dy                     rows that the instrument has shifted, each by noise of its
//        own
// ln S0 is a curve, linear between knots that are evenly spaced in sqrt f, and the prediction of ln P is ln S - 0.5772.
// q_k, the powers of harmonics over the first's, are those of the tiles that are set apart. W: Hann's window in
// frequency (tile_spectra.h), of f and of -f. phi, az: from the map's x axis towards its y axis, which runs down.
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "explain/heights/tile_spectra.h"

namespace gonio::explain::heights {

inline constexpr std::size_t harmonics = 6;
struct Grating {
  double period_m = 1, azimuth_rad = 0, amplitude_m = 0;  // of the first harmonic
  std::array<double, harmonics - 1> harmonic{};           // powers of the second and further over its
};
struct SpectrumState {
  std::vector<double> log_density;  // at the knots
  double a0 = 0, a45 = 0;
  Grating grating;
  double row_variance_m2 = 0;  // of the offset of one row of points
};

class SpectrumModel {
 public:
  explicit SpectrumModel(const TileSpectra& spectra);
  std::size_t knots() const { return knots_.size(); }
  double knot_per_m(std::size_t k) const;
  // ln P expected at every ordinate of a tile of this level.
  void predict(const SpectrumState& state, double level, std::span<double> log_power) const;
  // Least squares of the knots to the mean of some tiles, without the ordinates that stand out of it: where a fit
  // begins.
  std::vector<double> start(const std::vector<Tile>& tiles) const;
  // The line, with its harmonics, that explains most in the tiles that are set apart beside their roughness and its
  // lay, or the one of two or three times its period: the strongest ordinates and those that stand out most are tried.
  Grating search() const;

 private:
  double curve(const std::vector<double>& log_density, double log_f) const;
  // ln S without the grating, at ln |f| and the double angle of its direction.
  double roughness_at(const SpectrumState& state, double log_f, double cos_2, double sin_2) const;
  double roughness_at(const SpectrumState& state, std::size_t ordinate) const;
  // Knots and lay of what is no line: lines fill few ordinates, and count for little (Cauchy's loss).
  SpectrumState without_lines(const std::vector<double>& mean) const;
  Grating grating_at(double fx, double fy, const std::vector<double>& mean, const SpectrumState& beneath) const;
  Grating longest(const Grating& found, SpectrumState state, const std::vector<double>& mean) const;
  double misfit(const SpectrumState& state, const std::vector<double>& mean) const;
  const TileSpectra& spectra_;
  std::vector<double> knots_;                // sqrt f
  std::vector<double> log_f_, cos_2, sin_2;  // of every ordinate
};

}  // namespace gonio::explain::heights
