// How far stated probabilities can be believed: the share that was right against what was stated (reliability diagram,
// Murphy & Winkler 1977), and the expected calibration error, sum over bins of n_b / n |share right - mean stated|
// (Naeini, Cooper & Hauskrecht 2015).
#pragma once
#include <string>
#include <vector>

#include "report/page.h"

namespace gonio::sealed {

struct Stated {
  double probability = 0;
  bool right = false;
};
struct ReliabilityBin {
  double lower = 0, upper = 0;  // of the stated probability
  int asked = 0, right = 0;
  double mean = 0;  // stated
};
struct Reliability {
  std::vector<ReliabilityBin> bins;  // ascending, those that hold something
  int asked = 0;
  double error = 0;  // expected calibration error
  // What it is where every statement is true, by chance alone: the mean, and what one in twenty such columns exceeds.
  double error_by_chance = 0, error_by_chance_95 = 0;
};
// `bins` of equal width over 0 .. 1.
Reliability reliability_of(const std::vector<Stated>& stated, int bins = 10);
report::Plot reliability_plot(const Reliability& reliability);
report::TableText reliability_table(const Reliability& reliability);
std::string reliability_text(const Reliability& reliability);

}  // namespace gonio::sealed
