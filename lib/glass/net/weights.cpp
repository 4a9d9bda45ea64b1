// See weights.h.
#include "glass/net/weights.h"

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "manifest/value.h"

namespace gonio::glass {
namespace {

namespace fs = std::filesystem;
using manifest::Value;

constexpr const char* remedy = "train it again: scripts/glass-net/train";

const Value& member(const Value& of, const char* name, const std::string& place) {
  const Value* found = of.find(name);
  if (found == nullptr) throw Error(Exit::data, place, std::string("has no ") + name, remedy);
  return *found;
}
std::string text_of(const Value& of, const char* name, const std::string& place) {
  const Value& value = member(of, name, place);
  if (!value.is_string()) throw Error(Exit::data, place + "/" + name, "is no text", remedy);
  return value.as_string();
}
int count_of(const Value& value, const std::string& place, int least, int most) {
  if (!value.is_integer() || value.as_integer() < least || value.as_integer() > most)
    throw Error(Exit::data, place, "is no number from " + std::to_string(least) + " to " + std::to_string(most),
                remedy);
  return static_cast<int>(value.as_integer());
}
std::string one_of(const std::string& word, const std::vector<std::string>& words, const std::string& place) {
  if (std::ranges::find(words, word) == words.end()) throw Error(Exit::data, place, "is unknown: " + word, remedy);
  return word;
}

std::vector<double> numbers(const Value& of, const char* name, const std::string& place) {
  const Value& value = member(of, name, place);
  std::vector<double> all;
  if (value.is_array())
    for (const Value& v : value.as_array())
      if (v.is_number()) all.push_back(v.as_number());
  if (!value.is_array() || all.size() != value.as_array().size() || all.empty() || !std::ranges::is_sorted(all))
    throw Error(Exit::data, place + "/" + name, "is no list of ascending numbers", remedy);
  return all;
}

void read_calibration(const Value& record, const std::string& place, Weights& weights) {
  const Value* all = record.find("calibration");
  if (all == nullptr || all->is_null()) return;
  for (const std::string& head : weights.heads) {
    const std::string here = place + "/calibration/" + head;
    const Value& one = member(*all, head.c_str(), here);
    if (head == "mask") {
      const Value& temperature = member(one, "temperature", here);
      if (!temperature.is_number() || !(temperature.as_number() > 0))
        throw Error(Exit::data, here + "/temperature", "is no positive number", remedy);
      weights.temperature = temperature.as_number();
      continue;
    }
    Calibration c{numbers(one, "levels", here), numbers(one, "quantiles", here)};
    if (c.levels.size() != c.quantiles.size())
      throw Error(Exit::data, here, "has not as many levels as quantiles", remedy);
    weights.calibration[head] = std::move(c);
  }
}

}  // namespace

double Calibration::quantile(double level) const {
  const auto above = std::ranges::lower_bound(levels, level);
  if (above == levels.begin()) return quantiles.front();
  if (above == levels.end()) return quantiles.back();
  const auto k = static_cast<std::size_t>(above - levels.begin());
  const double t = (level - levels[k - 1]) / (levels[k] - levels[k - 1]);
  return std::lerp(quantiles[k - 1], quantiles[k], t);
}

Weights read_weights(const fs::path& folder) {
  Weights weights;
  weights.folder = folder;
  if (!fs::is_regular_file(folder / "run.json") || !fs::is_regular_file(folder / "network.onnx"))
    throw Error(Exit::no_input, folder.string(), "holds no network.onnx with its run.json",
                "glass-net has no weights of its own; scripts/glass-net/train makes some from a set of glass-make(1)");
  const std::string place = (folder / "run.json").string() + "#";
  const Value record = manifest::parse_json(read_file(folder / "run.json"), (folder / "run.json").string());
  const Value& how = member(record, "configuration", place);
  const std::string here = place + "/configuration";
  weights.input = one_of(text_of(how, "input", here), {"rgb", "stokes", "intensities"}, here + "/input");
  weights.light = one_of(text_of(how, "light", here), {"bare", "lit"}, here + "/light");
  weights.scales = one_of(text_of(how, "loss", here), {"paper", "scales"}, here + "/loss") == "scales";
  weights.levels = count_of(member(how, "levels", here), here + "/levels", 1, 8);
  const Value& heads = member(record, "heads", place);
  if (heads.is_array())
    for (const Value& head : heads.as_array())
      weights.heads.push_back(
          one_of(head.is_string() ? head.as_string() : "", {"mask", "depth", "front", "back"}, place + "/heads"));
  if (weights.heads.size() < 3 || weights.heads.front() != "mask")
    throw Error(Exit::data, place + "/heads", "are not mask, depth, front and back", remedy);
  const Value& size = member(record, "size_px", place);
  if (!size.is_array() || size.as_array().size() != 2)
    throw Error(Exit::data, place + "/size_px", "is no width and height", remedy);
  weights.width_px = count_of(size.as_array()[0], place + "/size_px/0", 1, 65536);
  weights.height_px = count_of(size.as_array()[1], place + "/size_px/1", 1, 65536);
  read_calibration(record, place, weights);
  const std::string bytes = read_file(folder / "network.onnx");
  if (sha256(bytes) != text_of(record, "network_sha256", place))
    throw Error(Exit::data, (folder / "network.onnx").string(), "is not the network that run.json is the record of",
                remedy);
  weights.network.assign(bytes.begin(), bytes.end());
  return weights;
}

}  // namespace gonio::glass
