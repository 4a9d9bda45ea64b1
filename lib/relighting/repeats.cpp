#include "relighting/repeats.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "stats/intervals.h"

namespace gonio::relighting {
namespace {

constexpr std::size_t bins = 20, least_pairs = 400;
constexpr double median_of_chi_square = 0.4549;

struct Pair {
  double mean, half_square;
};
using Pairs = std::map<std::size_t, std::vector<Pair>>;  // by image

void compare(const Recording& image, const io::Image& other, std::vector<Pair>& pairs) {
  for (std::size_t i = 0; i < image.counts.size(); ++i) {
    if (!image.counts[i]) continue;
    for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
      const double a = image.picture.data[c], b = other.data[c];
      if (std::isfinite(a) && std::isfinite(b)) pairs.push_back({0.5 * (a + b), 0.5 * (a - b) * (a - b)});
    }
  }
}

void check_size(const std::filesystem::path& path, const Recording& image, const io::Image& other) {
  if (other.width == image.picture.width && other.height == image.picture.height) return;
  throw Error(Exit::data, path.string(),
              "is " + std::to_string(other.width) + "x" + std::to_string(other.height) + " pixels, image \"" +
                  image.id + "\" " + std::to_string(image.picture.width) + "x" + std::to_string(image.picture.height),
              "give a further take of the same image");
}

void add_manifest(const std::filesystem::path& path, const Recordings& recordings, Pairs& pairs) {
  const Recordings others = read_recordings(manifest::read_document(path));
  bool any = false;
  for (std::size_t g = 0; g < recordings.images.size(); ++g)
    for (const Recording& other : others.images) {
      if (other.id != recordings.images[g].id) continue;
      check_size(path, recordings.images[g], other.picture);
      compare(recordings.images[g], other.picture, pairs[g]);
      any = true;
    }
  if (!any) throw Error(Exit::data, path.string(), "has no image of the recordings' ids", "keep the ids of images");
}

void add_picture(const std::filesystem::path& path, const manifest::Document& document, const Recordings& recordings,
                 Pairs& pairs) {
  for (std::size_t g = 0; g < recordings.images.size(); ++g) {
    const Recording& image = recordings.images[g];
    if (manifest::picture_path(document, image.entry).filename() != path.filename()) continue;
    const io::Image other = read_take(document, image, path);
    check_size(path, image, other);
    compare(image, other, pairs[g]);
    return;
  }
  throw Error(Exit::data, path.string(), "bears the file name of no image", "name repeats as the images are named");
}

// v / gain + read^2 by weighted least squares over bins; both terms held at or above zero.
manifest::Noise fitted(std::vector<Pair>& pairs) {
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.mean < b.mean; });
  double w = 0, wx = 0, wxx = 0, wy = 0, wxy = 0;
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t first = b * pairs.size() / bins, last = (b + 1) * pairs.size() / bins;
    std::vector<double> squares;
    double mean = 0;
    for (std::size_t i = first; i < last; ++i) squares.push_back(pairs[i].half_square), mean += pairs[i].mean;
    if (squares.empty()) continue;
    mean /= static_cast<double>(squares.size());
    const double variance = std::max(stats::median(squares) / median_of_chi_square, 1e-14),
                 weight = 1 / (variance * variance);
    w += weight, wx += weight * mean, wxx += weight * mean * mean;
    wy += weight * variance, wxy += weight * mean * variance;
  }
  const double determinant = w * wxx - wx * wx;
  double slope = determinant > 0 ? (w * wxy - wx * wy) / determinant : 0, floor = w > 0 ? (wy - slope * wx) / w : 0;
  if (slope < 0) slope = 0, floor = wy / w;
  if (floor < 0) floor = 0, slope = wxx > 0 ? wxy / wxx : 0;
  return {.gain = slope > 0 ? 1 / slope : 0, .read = std::max(std::sqrt(floor), 1e-6)};
}

}  // namespace

void measure_noise(std::span<const std::filesystem::path> repeats, const manifest::Document& document,
                   Recordings& recordings) {
  Pairs pairs;
  for (const std::filesystem::path& path : repeats)
    if (path.extension() == ".json")
      add_manifest(path, recordings, pairs);
    else
      add_picture(path, document, recordings, pairs);
  for (auto& [g, of_image] : pairs) {
    if (of_image.size() < least_pairs) continue;
    recordings.images[g].noise = fitted(of_image);
    recordings.images[g].variance.clear();  // what repeats show goes before what a file says
  }
}

}  // namespace gonio::relighting
