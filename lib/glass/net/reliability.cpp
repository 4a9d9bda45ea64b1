// See reliability.h.
#include "glass/net/reliability.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "glass/net/answer.h"
#include "io/npz.h"

namespace gonio::glass {
namespace {

namespace fs = std::filesystem;

struct Errors {
  std::vector<double> error, stated;  // of each pixel within the glass; stated: uncertainty
};

io::NpyArray read_tensor(const fs::path& set, const std::string& share, const std::string& name) {
  const fs::path path = set / "tensors" / (share + "-" + name + ".npy");
  if (!fs::is_regular_file(path))
    throw Error(Exit::no_input, path.string(), "is missing",
                "glass-make --gather writes it; a set of fewer than five objects has no test share");
  io::NpyArray array;
  if (!io::parse_npy(read_file(path), path.string(), array) || array.size.size() != 4)
    throw Error(Exit::data, path.string(), "is no array of four dimensions", "gather the set again");
  return array;
}

Planes cell_of(const io::NpyArray& array, std::size_t cell) {
  Planes planes{array.size[1], array.size[2], array.size[3], {}};
  const auto n = static_cast<std::ptrdiff_t>(planes.channels * planes.pixels());
  const auto first = array.values.begin() + static_cast<std::ptrdiff_t>(cell) * n;
  planes.values.assign(first, first + n);
  return planes;
}

const char* channel_of(const std::string& head) {
  return head == "front" ? "normal.X" : head == "back" ? "back_normal.X" : "depth.Z";
}

double error_at(const io::Image& answer, std::size_t i, const std::string& head, const Planes& truth) {
  const float* said =
      &answer.data[i * answer.channels.size() + static_cast<std::size_t>(answer.channel(channel_of(head)))];
  if (head == "depth") return std::abs(said[0] - truth.plane(0)[i]);
  double cosine = 0;
  for (std::size_t k = 0; k < 3; ++k) cosine += static_cast<double>(said[k]) * truth.plane(k)[i];
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

Reliability of_mask(const std::vector<double>& probability, const std::vector<bool>& glass) {
  Reliability r;
  r.bins.resize(10);
  for (std::size_t i = 0; i < probability.size(); ++i) {
    Reliability::Bin& bin = r.bins[std::min<std::size_t>(9, static_cast<std::size_t>(10 * probability[i]))];
    bin.stated += probability[i], bin.observed += glass[i] ? 1 : 0, ++bin.pixels;
    r.mean_error += (probability[i] > 0.5) != glass[i] ? 1 : 0;
  }
  const auto all = static_cast<double>(std::max<std::size_t>(1, probability.size()));
  for (Reliability::Bin& bin : r.bins) {
    if (bin.pixels == 0) continue;
    r.calibration_error += std::abs(bin.stated - bin.observed) / all;
    bin.stated /= static_cast<double>(bin.pixels), bin.observed /= static_cast<double>(bin.pixels);
  }
  r.mean_error /= all;
  return r;
}

std::vector<Reliability::Bin> fifths(const Errors& errors) {
  std::vector<std::size_t> order(errors.error.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t i) { return errors.stated[i]; });
  std::vector<Reliability::Bin> bins(5);
  for (std::size_t k = 0; k < order.size(); ++k) {
    Reliability::Bin& bin = bins[5 * k / order.size()];
    bin.stated += errors.stated[order[k]], ++bin.pixels;
    bin.observed += errors.error[order[k]] <= errors.stated[order[k]] ? 1 : 0;
  }
  for (Reliability::Bin& bin : bins)
    if (bin.pixels > 0) bin.stated /= static_cast<double>(bin.pixels), bin.observed /= static_cast<double>(bin.pixels);
  return bins;
}

Reliability of_errors(const Errors& errors, const Calibration* calibration) {
  Reliability r;
  for (const double e : errors.error) r.mean_error += e / static_cast<double>(errors.error.size());
  if (calibration == nullptr) return r;
  const double stated = calibration->quantile(uncertainty_level);
  for (int k = 1; k < 20; ++k) {
    const double level = k / 20.0, factor = calibration->quantile(level) / stated;
    Reliability::Bin bin{level, 0, errors.error.size()};
    for (std::size_t i = 0; i < errors.error.size(); ++i)
      bin.observed += errors.error[i] <= factor * errors.stated[i] ? 1.0 / static_cast<double>(bin.pixels) : 0;
    r.calibration_error += std::abs(bin.observed - level) / 19;
    r.bins.push_back(bin);
  }
  r.by_fifths = fifths(errors);
  return r;
}

}  // namespace

SetAnswers answers_of_set(const Weights& weights, const fs::path& set, const std::string& share) {
  const io::NpyArray seen = read_tensor(set, share, weights.input + "-" + weights.light);
  std::map<std::string, io::NpyArray> truth;
  for (const std::string& head : weights.heads) truth[head] = read_tensor(set, share, head);
  SetAnswers result{seen.size[0], {}};
  std::vector<double> probability;
  std::vector<bool> glass;
  std::map<std::string, Errors> errors;
  for (std::size_t cell = 0; cell < result.cells; ++cell) {
    Planes planes = cell_of(seen, cell);
    in_mean_light(planes, weights.input, format("%s: cell %zu", set.c_str(), cell));
    const io::Image answer = answer_of(weights, planes);
    const Planes mask = cell_of(truth.at("mask"), cell);
    const std::size_t width = answer.channels.size(), at_mask = static_cast<std::size_t>(answer.channel("mask"));
    for (std::size_t i = 0; i < mask.pixels(); ++i) {
      probability.push_back(answer.data[i * width + at_mask]);
      glass.push_back(mask.values[i] > 0.5F);
    }
    std::size_t uncertainty = width - weights.calibration.size();
    for (const std::string& head : weights.heads) {
      if (head == "mask") continue;
      const Planes said = cell_of(truth.at(head), cell);
      const bool known = weights.calibration.contains(head);
      for (std::size_t i = 0; i < mask.pixels(); ++i) {
        if (mask.values[i] <= 0.5F) continue;
        errors[head].error.push_back(error_at(answer, i, head, said));
        errors[head].stated.push_back(known ? answer.data[i * width + uncertainty] : 0);
      }
      uncertainty += known ? 1 : 0;
    }
  }
  result.heads["mask"] = of_mask(probability, glass);
  for (const auto& [head, of_head] : errors) {
    const auto found = weights.calibration.find(head);
    result.heads[head] = of_errors(of_head, found == weights.calibration.end() ? nullptr : &found->second);
  }
  return result;
}

std::string reliability_text(const Weights& weights, const SetAnswers& answers) {
  std::string text = format("%zu cells, %s, light: %s\n", answers.cells, weights.input.c_str(), weights.light.c_str());
  for (const std::string& head : weights.heads) {
    const Reliability& r = answers.heads.at(head);
    const double factor = head == "depth" ? 1e3 : head == "mask" ? 100 : 180 / M_PI;
    const char* unit = head == "depth" ? "mm" : head == "mask" ? "% of the pixels" : "degrees";
    text += format("%s: errs by %.3g %s", head.c_str(), factor * r.mean_error, unit);
    if (r.bins.empty()) {
      text += "; the weights say nothing of their errors\n";
      continue;
    }
    text += format(", calibration error %.2f %%\n  stated  ", 100 * r.calibration_error);
    for (const auto& bin : r.bins) text += bin.pixels > 0 ? format(" %5.1f", 100 * bin.stated) : "     -";
    text += " %\n  observed";
    for (const auto& bin : r.bins) text += bin.pixels > 0 ? format(" %5.1f", 100 * bin.observed) : "     -";
    text += " %\n";
    if (r.by_fifths.empty()) continue;
    text += format("  within its uncertainty (%.1f %%), by fifths of it:", 100 * uncertainty_level);
    for (const auto& bin : r.by_fifths)
      text += format("  %.3g %s %.1f %%", factor * bin.stated, unit, 100 * bin.observed);
    text += "\n";
  }
  return text;
}

}  // namespace gonio::glass
