// How high a voxel grows by the grey value that is projected, and which grey value a height needs.
//
// A photopolymer cures as deep as the light's energy exceeds a critical one, with the logarithm of it (Jacobs 1992,
// Rapid Prototyping & Manufacturing): for grey values I from 0 to 1, Luongo et al. 2020, equation 1,
//   h(I) = alpha + beta log(I - gamma)   for I > I0 = gamma + exp(-alpha / beta),   0 below;
// gamma is the light that black lets through (negative: some) or that stray light and inhibition take away. Inverted,
//   I(h) = gamma + exp((h - alpha) / beta)   for h > 0,   0 for h = 0,
// which begins at I0, and not at 0: their equation 2 as it stands maps heights beyond h(1) to greys above white (with
// their numbers and layers of 18 um white grows 17.8 um). What white does not reach is said here, not clipped in
// silence. Heights are metres over the layer below.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace gonio::print {

struct GrowthLaw {
  double alpha_m = 0, beta_m = 0, gamma = 0;
  double threshold() const;  // I0: the darkest grey that still cures
  double height_m(double grey) const;
  // Of a height that grows at a grey of at most 1; above it what it would need, more than 1.
  double grey(double height_m) const;
  std::array<double, 3> slopes(double grey) const;  // d height by alpha, beta, gamma; zero where nothing grows
};

// Heights at given greys where the law does not hold: rising, cubic between (Fritsch & Butland 1984), level beyond.
class GrowthTable {
 public:
  // `greys` ascending. Heights that fall are averaged with their neighbours, by weight (Ayer et al. 1955).
  GrowthTable(std::vector<double> greys, std::vector<double> heights_m, std::span<const double> weights);
  double height_m(double grey) const;
  // The darkest grey that reaches it; nothing where the brightest does not.
  std::optional<double> grey(double height_m) const;
  const std::vector<double>& greys() const { return greys_; }
  const std::vector<double>& heights_m() const { return heights_m_; }

 private:
  std::size_t piece(double grey) const;
  std::vector<double> greys_, heights_m_, slopes_;
};

// A gradient that was printed several times: mean height over each field. Every repetition has every grey.
struct PrintedGradient {
  std::vector<double> greys;                       // ascending, 0 to 1
  std::vector<std::vector<double>> repetitions_m;  // one list of heights per print of the gradient
};

struct GrowthFit {
  GrowthLaw law;
  std::array<std::array<double, 3>, 3> covariance{};  // alpha, beta (m), gamma
  // Sigmas and intervals are those of the repetitions, each taken as one: errors that fields of one print share, its
  // tilt or its plane of reference, count once. Student's degrees: repetitions - 1.
  double degrees = 0;
  std::array<double, 3> sigma() const;
  double height_sigma_m(double grey) const;
  // Is what is left of the means more than the repetitions' scatter allows? By signs of whole repetitions, along smooth
  // curves that the law cannot follow.
  double lack_of_fit_p = 1;
  double rms_m = 0;  // of the means about the law
  std::vector<double> means_m, mean_sigmas_m;
  GrowthTable table;  // the means themselves, for where the law fails
};

// At least five greys of which three grow, and four repetitions: Error(data) at `place` otherwise, or where heights do
// not rise with grey.
GrowthFit fit_growth(const PrintedGradient& printed, const char* place);

}  // namespace gonio::print
