// Which terms a law has, and whether it extrapolates. Private to the law.
#pragma once
#include <functional>
#include <vector>

#include "inference/law_data.h"
#include "inference/law_terms.h"

namespace gonio::inference {

// One way across the split of a condition: a law fitted on one side with its own free parameters, judged on the other
// with those that serve all rows. Falls are of chi-square on the judged side.
struct Way {
  double law = 0;                // with the coefficients of the other side
  double own = 0;                // with those fitted here
  double curve = 0;              // of a free curve from the other side that goes on with its last value
  double expected = 0;           // what the law of all rows would bring here, and
  double unsure = 0;             // what the uncertainty of the other side's coefficients takes away from that
  std::vector<double> block;     // fall of the law, block by block
  double before = 0, after = 0;  // score in the user's unit
  // Is there enough to be seen on both sides?
  bool tells() const { return expected > 12 && unsure < 0.25 * expected; }
};
struct Extrapolation {
  std::size_t condition = 0;
  bool by_size = false;  // the split is of |value|: the condition takes both signs
  double split = 0;
  Way outwards{}, inwards{};
  double law = 0, sigma = 0;  // fall over the ways that tell, and its standard error over blocks
  bool passes = false;
};
// The terms as the rows of a mask want them: scales that the fitted side is to choose by itself.
using Tuned = std::function<std::vector<Term>(const Mask&)>;
// The split is where both sides have most to tell, which does not look at how well the law does there.
Extrapolation extrapolate(const LawData& data, const std::vector<Term>& terms, std::size_t condition,
                          const Tuned& tuned = {});

// The best law with one more term than `terms`, the earlier ones exchanged where others now serve better; empty: no
// term is significant at `level` among all that were looked at.
std::vector<Term> with_one_more(const LawData& data, const std::vector<Term>& possible, std::vector<Term> terms,
                                double level);
// Single terms nearly as good as the best one, best first.
std::vector<Term> good_singles(const LawData& data, const std::vector<Term>& possible, double level);

// Hats over the quantiles of one condition, with its direction: a free curve.
RawColumns free_curve(const System& system, std::size_t condition);

RawColumns columns_of(const LawData& data, const std::vector<Term>& terms);
std::vector<double> combined(const RawColumns& columns, const Eigen::VectorXd& coefficients);

}  // namespace gonio::inference
