// Where fits begin: what the samples show at a glance, and random numbers about it.
//   floor    median of f where half vectors lean away by more than 0.5 rad: the matte part
//   g        (f - floor) 4 ci co, which is F D G of one facet; its peak is taken over the half vectors nearest to the
//            normal, or of any direction where a relief leans its facets
//   alpha    the slope tan theta_h at which g has fallen to a quarter: GGX falls so at its roughness
//   f0       g at the peak times pi alpha^2
#pragma once
#include <vector>

#include "goniometry/fit/fit_problem.h"

namespace gonio::goniometry {

struct Guess {
  std::vector<double> floor, f0;  // per band; floor in 1/sr
  double alpha = 0.1;
  double tilt_rad = 0, azimuth_rad = 0;  // of the brightest half vector
};
Guess guess_of(const Problem& problem);

// In a fixed order: first without random numbers.
std::vector<std::vector<double>> starts(const Candidate& candidate, const Guess& guess, std::size_t bands,
                                        int random_starts, std::uint64_t seed);

// Does `to` add a lobe, light sent back, a direction or a rough base to the same numbers?
bool grows(const Candidate& from, const Candidate& to);
// Beginnings of `to` from where `from` ended, what is added small: a second lobe wider, and narrower, than the first.
std::vector<std::vector<double>> grown(const Candidate& from, const std::vector<double>& x, const Candidate& to,
                                       const Guess& guess);

// Rows and bands that decide between starts: all near the peak and some of the rest; first, middle and last band.
Samples few_of(const Problem& problem, std::vector<std::size_t>& bands);
Samples chosen_rows(const Samples& samples, const Rows& rows, const std::vector<std::size_t>& bands);

}  // namespace gonio::goniometry
