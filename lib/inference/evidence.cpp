// See evidence.h.
#include "inference/evidence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/atomic_file.h"
#include "inference/law_data.h"
#include "manifest/document.h"

namespace gonio::inference {
namespace {

// Linear between the bins' centres, constant beyond them.
double curve_at(const Curve& curve, double x) {
  if (curve.centre.empty() || !std::isfinite(x)) return 0;
  const auto above = std::upper_bound(curve.centre.begin(), curve.centre.end(), x);
  if (above == curve.centre.begin()) return curve.before.front();
  if (above == curve.centre.end()) return curve.before.back();
  const auto k = static_cast<std::size_t>(above - curve.centre.begin());
  const double t = (x - curve.centre[k - 1]) / (curve.centre[k] - curve.centre[k - 1]);
  return (1 - t) * curve.before[k - 1] + t * curve.before[k];
}

std::vector<double> along_the_curve(const Observations& o, const LocatedCondition& located) {
  std::vector<double> change(o.rows(), 0.0);
  for (const Condition& c : o.conditions)
    if (c.name == located.name)
      for (std::size_t i = 0; i < change.size(); ++i)
        change[i] = curve_at(located.curve, c.values[i]) * (c.direction.empty() ? 1 : c.direction[i]);
  return change;
}

// What the free parameters leave of a law: the part that they take is no mismatch anywhere.
std::vector<double> surviving(const Problem& problem, const Explanation& e, const std::vector<double>& law) {
  const System system(problem, 1);
  const Eigen::MatrixXd projected = LawData(system, e.values, e.active).projected({law});
  std::vector<double> left(law.size(), 0.0);
  for (std::size_t i = 0; i < left.size(); ++i)
    if (system.weight(i) > 0) left[i] = projected(static_cast<Eigen::Index>(i), 0) / system.weight(i);
  return left;
}

// Quotes where commas or quotes would break the row.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::vector<double> effects(const Problem& problem, const Explanation& e) {
  const Observations& o = problem.observations();
  std::vector<double> change(o.rows(), 0.0);
  const auto located = [&](const std::string& name) {
    return std::find_if(e.conditions.begin(), e.conditions.end(),
                        [&](const LocatedCondition& c) { return c.name == name; });
  };
  if (!e.named.empty()) {
    for (std::size_t i = 0; i < change.size(); ++i) change[i] = e.residual_before[i] - e.residual_after[i];
  } else if (e.outside && e.outside->per_row.size() == change.size()) {
    change = surviving(problem, e, e.outside->per_row);
  } else if (e.outside && located(e.outside->condition) != e.conditions.end()) {
    change = along_the_curve(o, *located(e.outside->condition));
  } else if (!e.conditions.empty()) {
    change = along_the_curve(o, e.conditions[0]);
  }
  for (std::size_t i = 0; i < change.size(); ++i) {
    change[i] = std::abs(change[i]) / (e.noise_factor * o.sigma[i]);
    if (!std::isfinite(change[i])) change[i] = 0;
  }
  return change;
}

std::string write_evidence(const Problem& problem, const Explanation& e, const std::string& name,
                           const std::filesystem::path& out, manifest::Document& document) {
  const Observations& o = problem.observations();
  const std::vector<double> effect = effects(problem, e);
  std::string text = "row,group,observed,before,after,sigma,effect\n";
  for (std::size_t g = 0; g < o.groups(); ++g) {
    const std::string group = field(o.group[g]);
    for (std::size_t i = o.first[g]; i < o.first[g + 1]; ++i) {
      char numbers[192];
      std::snprintf(numbers, sizeof numbers, ",%.9g,%.9g,%.9g,%.4g,%.4g\n", o.value[i],
                    o.value[i] - e.residual_before[i], o.value[i] - e.residual_after[i], e.noise_factor * o.sigma[i],
                    effect[i]);
      text += std::to_string(i) + "," + group + numbers;
    }
  }
  const std::filesystem::path path = out / ("evidence-" + name + ".csv");
  write_file(path, text);
  return manifest::add_file(document, path, "evidence-" + name);
}

}  // namespace gonio::inference
