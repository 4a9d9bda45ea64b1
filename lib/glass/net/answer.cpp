// See answer.h.
#include "glass/net/answer.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/loaded_library.h"
#include "glass/net/onnx_module.h"

namespace gonio::glass {
namespace {

// Log scales that training bounds alike (network.py, loss_of_scales).
constexpr float least_log_scale = -6, largest_log_scale = 3;

struct Head {
  std::string channel;   // of the answer; vectors: with .X, .Y, .Z
  std::size_t size = 1;  // components
};
Head head_named(const std::string& name) {
  if (name == "front") return {"normal", 3};
  if (name == "back") return {"back_normal", 3};
  return {name == "depth" ? "depth.Z" : name, 1};
}

std::size_t channels_out(const Weights& weights) {
  std::size_t sum = 0;
  for (const std::string& head : weights.heads)
    sum += head_named(head).size + (weights.scales && head != "mask" ? 1 : 0);
  return sum;
}

Planes through_network(const Weights& weights, const Planes& tile) {
  static auto* const answers_of = loaded_from_module<decltype(gonio_onnx_answers)>("onnx", "gonio_onnx_answers");
  Planes out;
  std::string error;
  answers_of(weights.network, tile.values, tile.channels, tile.height, tile.width, out.values, out.channels, out.height,
             out.width, error);
  const std::string place = (weights.folder / "network.onnx").string();
  if (!error.empty()) throw Error(Exit::data, place, "is not understood: " + error, "train it again");
  if (out.channels != channels_out(weights) || out.height != tile.height || out.width != tile.width)
    throw Error(Exit::data, place, "answers with another size than its record states", "train it again");
  return out;
}

// Rows from `top`, columns from `left`; beyond the picture its last pixel.
Planes cut(const Planes& from, std::size_t top, std::size_t left, std::size_t height, std::size_t width) {
  Planes part{from.channels, height, width, std::vector<float>(from.channels * height * width)};
  for (std::size_t c = 0; c < from.channels; ++c)
    for (std::size_t y = 0; y < height; ++y)
      for (std::size_t x = 0; x < width; ++x)
        part.plane(c)[y * width + x] =
            from.plane(c)[std::min(top + y, from.height - 1) * from.width + std::min(left + x, from.width - 1)];
  return part;
}

struct Span {
  std::size_t from, size, first, count;  // of the tile; of what is kept of it, within the picture
};
// Parts of a side of `length` pixels: no longer than `tile`, overlapping by twice `reach`, beginning at multiples of
// `step`.
std::vector<Span> spans(std::size_t length, std::size_t tile, std::size_t reach, std::size_t step) {
  const auto up = [&](std::size_t n) { return (n + step - 1) / step * step; };
  if (length <= tile) return {{0, up(length), 0, length}};
  const std::size_t margin = up(reach),
                    kept = std::max(step, tile > 2 * margin ? (tile - 2 * margin) / step * step : step);
  std::vector<Span> all;
  for (std::size_t first = 0; first < length; first += kept) {
    const std::size_t count = std::min(kept, length - first), from = first > margin ? first - margin : 0;
    const std::size_t end = std::min(up(length), up(first + count) + margin);
    all.push_back({from, end - from, first, count});
  }
  return all;
}

Planes answers_in_tiles(const Weights& weights, const Planes& seen, int tile_px) {
  const auto step = static_cast<std::size_t>(step_of(weights)), reach = static_cast<std::size_t>(reach_of(weights));
  const auto tile = static_cast<std::size_t>(tile_px);
  Planes all{channels_out(weights), seen.height, seen.width, {}};
  all.values.resize(all.channels * all.pixels());
  for (const Span& rows : spans(seen.height, tile, reach, step))
    for (const Span& columns : spans(seen.width, tile, reach, step)) {
      const Planes part = through_network(weights, cut(seen, rows.from, columns.from, rows.size, columns.size));
      for (std::size_t c = 0; c < all.channels; ++c)
        for (std::size_t y = 0; y < rows.count; ++y)
          std::copy_n(part.plane(c) + (rows.first - rows.from + y) * part.width + columns.first - columns.from,
                      columns.count, all.plane(c) + (rows.first + y) * all.width + columns.first);
    }
  return all;
}

float tempered(float probability, double temperature) {
  const double p = std::clamp(static_cast<double>(probability), 1e-7, 1 - 1e-7);
  return static_cast<float>(1 / (1 + std::exp(-std::log(p / (1 - p)) / temperature)));
}

std::vector<std::string> answer_channels(const Weights& weights) {
  std::vector<std::string> names;
  for (const std::string& name : weights.heads) {
    const Head head = head_named(name);
    for (std::size_t k = 0; k < head.size; ++k)
      names.push_back(head.size == 1 ? head.channel : head.channel + "." + "XYZ"[k]);
  }
  for (const std::string& name : weights.heads)
    if (weights.calibration.contains(name)) names.push_back("uncertainty." + head_named(name).channel);
  return names;
}

void normalize(float* v) {
  const float length = std::hypot(v[0], v[1], v[2]);
  if (!(length > 0)) return;
  for (int k = 0; k < 3; ++k) v[k] /= length;
}

}  // namespace

io::Image answer_of(const Weights& weights, const Planes& seen, int tile_px) {
  const Planes raw = answers_in_tiles(weights, seen, tile_px);
  io::Image answer(static_cast<int>(seen.width), static_cast<int>(seen.height), answer_channels(weights));
  const std::size_t width = answer.channels.size();
  for (std::size_t i = 0; i < raw.pixels(); ++i) {
    float* at = &answer.data[i * width];
    std::size_t from = 0, to = 0;
    std::size_t uncertainty = width - weights.calibration.size();
    for (const std::string& name : weights.heads) {
      const Head head = head_named(name);
      for (std::size_t k = 0; k < head.size; ++k) at[to + k] = raw.plane(from + k)[i];
      if (name == "mask") at[to] = tempered(at[to], weights.temperature);
      if (head.size == 3) normalize(at + to);
      from += head.size, to += head.size;
      if (name == "mask") continue;
      const float scale =
          weights.scales ? std::exp(std::clamp(raw.plane(from)[i], least_log_scale, largest_log_scale)) : 1;
      if (weights.scales) ++from;
      if (const auto found = weights.calibration.find(name); found != weights.calibration.end())
        at[uncertainty++] = scale * static_cast<float>(found->second.quantile(uncertainty_level));
    }
  }
  return answer;
}

io::Image as_photographed(const io::Image& answer, int shrink, int width, int height) {
  io::Image full(width, height, answer.channels);
  const int n = static_cast<int>(answer.channels.size());
  const auto place = [shrink](int i, int count) {  // of a pixel's centre among those of the blocks
    return std::clamp((i + 0.5) / shrink - 0.5, 0.0, count - 1.0);
  };
  const int mask = answer.channel("mask");
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = place(x, answer.width), v = place(y, answer.height);
      const int left = static_cast<int>(u), top = static_cast<int>(v);
      const int right = std::min(left + 1, answer.width - 1), below = std::min(top + 1, answer.height - 1);
      float* at = &full.data[full.index(x, y, 0)];
      for (int c = 0; c < n; ++c)
        at[c] = static_cast<float>(std::lerp(std::lerp(answer.at(left, top, c), answer.at(right, top, c), u - left),
                                             std::lerp(answer.at(left, below, c), answer.at(right, below, c), u - left),
                                             v - top));
      for (const char* normal : {"normal.X", "back_normal.X"})
        if (const int c = answer.channel(normal); c >= 0) normalize(at + c);
      if (at[mask] >= 0.5F) continue;
      for (int c = 0; c < n; ++c)
        if (c != mask) at[c] = 0;
    }
  return full;
}

}  // namespace gonio::glass
