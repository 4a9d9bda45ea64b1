// Whether nrsfm-eval's 90 % intervals contain the error of a long sequence of the same kind, by how long errors stay
// correlated: the measure alone, with the alignment given, and the robust error with its own alignment.
//   prove-nrsfm-intervals SEQUENCES: prints a table, fails where coverage is below what error_intervals.h states.
// Errors of a frame have a size 0.01 exp(0.5 a_f); a_f is a first-order autoregression, or one that swings with a
// period of 25 frames.
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "nrsfm/evaluate/erring.h"
#include "nrsfm/evaluate/error_intervals.h"

namespace {

using namespace gonio;
using namespace gonio::nrsfm;

struct Case {
  std::string name;
  tests::Process process;
  Eigen::Index frames;
  double required;  // stated coverage less 3 standard deviations of 400 sequences
};

struct Counted {
  double covered = 0, width = 0;
};

Aligned fitted(const Aligned& a, std::uint64_t seed) {
  Random random(seed, 3);
  const Shapes x = tests::moved_all(a.shapes, 2, tests::any_rotation(random), {1, 2, 3});
  const Similarity s = robust_error(x, a.truth).alignment;
  Aligned out{Shapes(x.rows(), x.cols()), a.truth, {}, {}};
  for (Eigen::Index f = 0; f < x.rows() / 3; ++f) shape_of(out.shapes, f) = moved(s, shape_of(x, f));
  return out;
}

Counted count(const Case& c, Measure measure, bool fit, int sequences) {
  const Shapes q = tests::deforming(25, 12, 1);
  const double truth = error_interval(tests::erring(q, 60000, c.process, 1000), measure, {.draws = 0}).value;
  std::vector<double> covered(sequences), width(sequences);
  parallel_for(0, sequences, [&](std::size_t k) {
    Aligned a = tests::erring(q, c.frames, c.process, k);
    if (fit) a = fitted(a, k);
    const ErrorInterval i = error_interval(a, measure, {.draws = 200, .confidence = 0.9, .seed = k});
    covered[k] = i.lower <= truth && truth <= i.upper;
    width[k] = 0.5 * std::log(i.upper / i.lower);
  });
  Counted out;
  for (int k = 0; k < sequences; ++k) out.covered += covered[k] / sequences, out.width += width[k] / sequences;
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  const int sequences = argc > 1 ? std::stoi(argv[1]) : 400;
  const tests::Process swing{2 * 0.9 * std::cos(2 * 3.141592653589793 / 25), -0.81};
  const std::vector<Case> cases = {{"no correlation", {0}, 100, 0.86},
                                   {"a = 0.6", {0.6}, 100, 0.84},
                                   {"a = 0.8", {0.8}, 100, 0.84},
                                   {"a = 0.9", {0.9}, 100, 0.83},
                                   {"a = 0.95", {0.95}, 100, 0.75},
                                   {"swings of 25 frames", swing, 100, 0.84},
                                   {"a = 0.9, 300 frames", {0.9}, 300, 0.84},
                                   {"a = 0.95, 300 frames", {0.95}, 300, 0.82},
                                   {"no correlation, 12 frames", {0}, 12, 0.80}};
  int failed = 0;
  for (const Case& c : cases)
    for (const auto& [measure, fit] :
         {std::pair{Measure::robust_rms, false}, {Measure::e3d, false}, {Measure::robust_rms, true}}) {
      const Counted n = count(c, measure, fit, sequences);
      const bool held = n.covered >= c.required;
      failed += !held;
      std::printf("nrsfm-intervals: %s, %s%s: measured %.3f of 0.9, half width %.0f %%; required %.2f%s\n",
                  c.name.c_str(), measure_names()[static_cast<std::size_t>(measure)].c_str(),
                  fit ? " with its alignment" : "", n.covered, 100 * n.width, c.required, held ? "" : ": NOT MET");
      std::fflush(stdout);
    }
  return failed == 0 ? 0 : 1;
}
