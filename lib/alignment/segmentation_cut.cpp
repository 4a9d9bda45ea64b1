// The object as a minimum cut, and small repairs of labels: see segmentation_field.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>

#include "alignment/segmentation_field.h"
#include "base/error.h"

namespace gonio::alignment {
namespace {

// Half of the neighbours; the others are the same pairs from the other end.
constexpr std::array<std::array<int, 2>, 4> steps{{{1, 0}, {0, 1}, {1, 1}, {-1, 1}}};

// Mean over the channels of the squared difference of two pixels, in units of their noise and the model's error, in the
// picture where they differ least: the rim of an object is an edge under every lamp, that of a shadow under one.
double difference(const Field& field, std::size_t p, std::size_t q) {
  const auto channels = static_cast<std::size_t>(field.channels);
  double least = HUGE_VAL;
  for (const LampPicture& picture : field.pictures) {
    double sum = 0;
    for (std::size_t c = 0; c < channels; ++c) {
      const std::size_t i = p * channels + c, j = q * channels + c;
      const double a = static_cast<double>(picture.value[i] / picture.ground[i]);
      const double b = static_cast<double>(picture.value[j] / picture.ground[j]);
      const double sa = static_cast<double>(picture.sigma[i] / picture.ground[i]);
      const double sb = static_cast<double>(picture.sigma[j] / picture.ground[j]),
                   model = picture.model_error * std::max(a, b);
      sum += (a - b) * (a - b) / (sa * sa + sb * sb + model * model);
    }
    least = std::min(least, sum / static_cast<double>(channels));
  }
  return least;
}

template <class Visit>
void pairs(const Field& field, const Visit& visit) {
  for (int y = 0; y < field.height; ++y)
    for (int x = 0; x < field.width; ++x)
      for (const auto& [dx, dy] : steps) {
        if (x + dx < 0 || x + dx >= field.width || y + dy >= field.height) continue;
        const auto w = static_cast<std::size_t>(field.width);
        visit(static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x),
              static_cast<std::size_t>(y + dy) * w + static_cast<std::size_t>(x + dx),
              dx != 0 && dy != 0 ? 0.7071 : 1.0);
      }
}

constexpr float dark_beyond = -1;           // of the ratio's logarithm
constexpr float sure_of_one = 3, sure = 5;  // nats, of one picture and of several
constexpr std::size_t touching = 8;         // pixels (seen from either of two) by which a part meets an object

}  // namespace

std::vector<std::uint8_t> beyond_ground(const Field& field, std::span<const float> evidence) {
  const auto w = static_cast<std::size_t>(field.width), h = static_cast<std::size_t>(field.height);
  std::vector<std::uint8_t> dark(field.pixels(), 1), seen(field.pixels()), beyond(field.pixels());
  for (const LampPicture& picture : field.pictures)
    for (std::size_t p = 0; p < field.pixels(); ++p) dark[p] = dark[p] && picture.brightness[p] < dark_beyond;
  const float enough = field.pictures.size() == 1 ? sure_of_one : sure;
  const auto follow = [&](std::size_t start) {
    if (!dark[start] || seen[start]) return;
    std::vector<std::size_t> part{start};
    seen[start] = 1;
    std::size_t object = 0;
    for (std::size_t i = 0; i < part.size(); ++i)
      around(field, part[i], 1, [&](std::size_t q) {
        if (dark[q] && !seen[q]) seen[q] = 1, part.push_back(q);
      });
    // What touches it stands two pixels off, past those that hold both.
    for (const std::size_t p : part)
      around(field, p, 2, [&](std::size_t q) { object += !dark[q] && evidence[q] > enough; });
    if (object > touching) return;
    for (const std::size_t p : part) around(field, p, 2, [&](std::size_t q) { beyond[q] = 1; });
  };
  for (std::size_t x = 0; x < w; ++x) follow(x), follow((h - 1) * w + x);
  for (std::size_t y = 0; y < h; ++y) follow(y * w), follow(y * w + w - 1);
  return beyond;
}

std::vector<std::uint8_t> cut_object(const Field& field, std::span<const float> evidence, double tie) {
  const auto count = static_cast<int>(field.pixels());
  std::vector<float> all;
  all.reserve(4 * field.pixels());
  pairs(field,
        [&](std::size_t p, std::size_t q, double) { all.push_back(static_cast<float>(difference(field, p, q))); });
  std::vector<float> sorted = all;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double usual = std::max(1.0, static_cast<double>(*middle));  // of a textured ground more than noise

  cv::detail::GCGraph<double> graph(static_cast<unsigned>(count), static_cast<unsigned>(2 * all.size()));
  for (int p = 0; p < count; ++p) {
    graph.addVtx();
    const bool beyond = !field.beyond.empty() && field.beyond[static_cast<std::size_t>(p)];
    const double e = beyond ? -1e3 : static_cast<double>(evidence[static_cast<std::size_t>(p)]);
    graph.addTermWeights(p, std::max(e, 0.0), std::max(-e, 0.0));
  }
  std::size_t n = 0;
  pairs(field, [&](std::size_t p, std::size_t q, double weight) {
    const double w = weight * tie * (0.02 + std::exp(-static_cast<double>(all[n++]) / (4 * usual)));
    graph.addEdges(static_cast<int>(p), static_cast<int>(q), w, w);
  });
  graph.maxFlow();
  std::vector<std::uint8_t> object(field.pixels());
  for (int p = 0; p < count; ++p) object[static_cast<std::size_t>(p)] = graph.inSourceSegment(p);
  return object;
}

void clean(Segmentation& segmentation) {
  const std::vector<Label> before = segmentation.labels;
  const auto w = static_cast<std::size_t>(segmentation.width);
  for (int y = 0; y < segmentation.height; ++y)
    for (int x = 0; x < segmentation.width; ++x) {
      std::array<int, 4> votes{};
      for (int j = std::max(0, y - 1); j <= std::min(segmentation.height - 1, y + 1); ++j)
        for (int i = std::max(0, x - 1); i <= std::min(segmentation.width - 1, x + 1); ++i)
          ++votes[static_cast<std::size_t>(before[static_cast<std::size_t>(j) * w + static_cast<std::size_t>(i)])];
      const std::size_t p = static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x);
      if (votes[static_cast<std::size_t>(before[p])] > 2) continue;  // itself, and two like it: a rim or a thin line
      const auto most = std::max_element(votes.begin(), votes.end()) - votes.begin();
      const auto label = static_cast<Label>(most);
      if (label == before[p]) continue;
      segmentation.labels[p] = label;
      if (before[p] == Label::object) segmentation.object_share[p] = std::min(segmentation.object_share[p], 0.49f);
      if (label == Label::object) segmentation.object_share[p] = std::max(segmentation.object_share[p], 0.51f);
    }
}

void check_object(const Segmentation& segmentation, const std::string& place) {
  const auto w = static_cast<std::size_t>(segmentation.width), h = static_cast<std::size_t>(segmentation.height);
  const auto is = [&](std::size_t x, std::size_t y) { return segmentation.labels[y * w + x] == Label::object; };
  if (std::count(segmentation.labels.begin(), segmentation.labels.end(), Label::object) < 20)
    throw Error(Exit::data, place, "no object stands out from the ground",
                "light it so that it differs, or mark it by strokes");
  std::array<int, 4> met{};  // left, right, upper, lower
  for (std::size_t y = 0; y < h; ++y) met[0] += is(0, y), met[1] += is(w - 1, y);
  for (std::size_t x = 0; x < w; ++x) met[2] += is(x, 0), met[3] += is(x, h - 1);
  constexpr std::array<const char*, 4> names{"left", "right", "upper", "lower"};
  for (std::size_t side = 0; side < 4; ++side)
    if (met[side] > 2)
      throw Error(Exit::data, place, std::string("the object meets the ") + names[side] + " border of the picture",
                  "frame it with ground on all sides, or mark it by strokes");
}

double certainty_of(const Segmentation& segmentation) {
  const auto unknown = std::count(segmentation.labels.begin(), segmentation.labels.end(), Label::unknown);
  return 1 - static_cast<double>(unknown) / static_cast<double>(segmentation.labels.size());
}

}  // namespace gonio::alignment
