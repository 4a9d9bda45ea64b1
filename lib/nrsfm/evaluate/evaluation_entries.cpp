// See evaluation_entries.h.
#include "nrsfm/evaluate/evaluation_entries.h"

#include <cmath>
#include <set>

#include "base/text.h"
#include "manifest/sections/evaluation.h"

namespace gonio::nrsfm {
namespace {

// Value in the truth's unit to metres, where its length is known.
struct Scale {
  double factor = 1;
  std::string unit;
};
Scale scale_of(Measure measure, double unit_m) {
  if (measure == Measure::e3d || measure == Measure::nrmse) return {1, "1"};
  const bool root = measure == Measure::robust_printed;
  if (!(unit_m > 0)) return {1, root ? "root of the truth's" : "of the truth"};
  return {root ? std::sqrt(unit_m) : unit_m, root ? "sqrt(m)" : "m"};
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

}  // namespace

manifest::Evaluation entry_of(const Submission& submission, const Sequence& sequence, const Evaluated& e,
                              const EvaluationOptions& options) {
  manifest::Evaluation out;
  out.id = submission.id, out.sequence = sequence.name, out.algorithm = submission.reconstruction.name;
  out.factors = sequence.factors;
  for (const auto& [factor, level] : submission.reconstruction.factors) out.factors[factor] = level;
  for (const MeasuredError& error : e.errors) {
    const Scale scale = scale_of(error.measure, sequence.unit_m);
    manifest::EvaluatedError entry{measure_names()[static_cast<std::size_t>(error.measure)],
                                   error.alignment,
                                   scale.unit,
                                   scale.factor * error.value,
                                   {},
                                   {}};
    if (error.interval && std::isfinite(error.interval->upper))
      entry.lower = scale.factor * error.interval->lower, entry.upper = scale.factor * error.interval->upper;
    out.errors.push_back(std::move(entry));
  }
  if (options.intervals) out.confidence = options.intervals->confidence;
  if (options.intervals && e.block > 0) out.block = static_cast<double>(e.block);
  out.whisker = e.robust.whisker, out.truncated = e.robust.truncated, out.estimated_share = e.robust.estimated;
  out.scale = e.robust.alignment.scale;
  out.mirrored = options.flips ? e.flips.whole_sequence_mirrored : e.robust.alignment.mirrored();
  out.converged = e.robust.converged;
  for (const Flip& flip : e.flips.frames)
    out.flips.push_back(
        {flip.frame, flip.kind == FlipKind::mirror ? "mirror" : "depth-reversal", flip.error_before, flip.error_after});
  out.notes = submission.notes;
  out.notes.insert(out.notes.end(), e.notes.begin(), e.notes.end());
  return out;
}

std::string evaluations_csv(const std::vector<manifest::Evaluation>& evaluations) {
  std::set<std::string> factors;
  for (const manifest::Evaluation& e : evaluations)
    for (const auto& [factor, level] : e.factors)
      if (factor != "algorithm") factors.insert(factor);
  std::string csv = "id,sequence,algorithm";
  for (const std::string& factor : factors) csv += "," + quoted(factor);
  csv += ",measure,alignment,value,lower,upper,unit,truncated,estimated_share,mirrored,flips\n";
  const auto number = [](const std::optional<double>& v) { return v ? shortest_text(*v) : std::string(); };
  for (const manifest::Evaluation& e : evaluations) {
    std::string head = quoted(e.id) + "," + quoted(e.sequence) + "," + quoted(e.algorithm);
    for (const std::string& factor : factors)
      head += "," + (e.factors.contains(factor) ? quoted(e.factors.at(factor)) : std::string());
    for (const manifest::EvaluatedError& error : e.errors)
      csv += head + "," + error.measure + "," + error.alignment + "," + shortest_text(error.value) + "," +
             number(error.lower) + "," + number(error.upper) + "," + quoted(error.unit) + "," + number(e.truncated) +
             "," + number(e.estimated_share) + "," + (e.mirrored.value_or(false) ? "1" : "0") + "," +
             std::to_string(e.flips.size()) + "\n";
  }
  return csv;
}

}  // namespace gonio::nrsfm
