// See moved_outcome.h.
#include "explain/stacks/moved_outcome.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "explain/stacks/stack_manifest.h"
#include "inference/apart.h"
#include "inference/sentence.h"
#include "inference/wording.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "stats/intervals.h"

namespace gonio::mechanism {
const Mechanism& scene_moved();
}

namespace gonio::explain::stacks {
namespace {

constexpr std::size_t most_shown = 3;

// A part of a picture as an eye would see it, brightest where readings over `white` are.
std::string preview(const Stack& stack, std::size_t image, const Box& part, double gain, double white) {
  const io::Image& picture = stack.images[image].picture;
  io::Image shown(part.width, part.height, stack.channels);
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x)
      for (int c = 0; c < static_cast<int>(stack.channels.size()); ++c) {
        const double v = gain * picture.at(part.x + x, part.y + y, c) / white;
        shown.at(x, y, c) = static_cast<float>(std::pow(std::clamp(v, 0.0, 1.0), 1 / 2.2));
      }
  return io::encode_png(shown);
}

Box with_surroundings(const Stack& stack, const MovedRegion& r) {
  const int margin = std::max(16, std::max(r.width_px, r.height_px) / 2);
  const int left = std::max(0, r.left_px - margin), top = std::max(0, r.top_px - margin);
  return {stack.images[r.image].id, left, top, std::min(stack.width(), r.left_px + r.width_px + margin) - left,
          std::min(stack.height(), r.top_px + r.height_px + margin) - top};
}

// The picture with the nearest exposure.
std::size_t beside(const Stack& stack, std::size_t image) {
  std::size_t best = image == 0 ? 1 : 0;
  const auto away = [&](std::size_t g) {
    return std::abs(std::log(stack.images[g].exposure_s / stack.images[image].exposure_s));
  };
  for (std::size_t g = 0; g < stack.images.size(); ++g)
    if (g != image && away(g) < away(best)) best = g;
  return best;
}

}  // namespace

void leave_out_stated(const manifest::Document& document, Stack& stack) {
  const std::string& id = mechanism::scene_moved().id;
  for (StackImage& image : stack.images) {
    if (!is_given(document, id, image.id)) continue;
    std::array<double, 4> box{};
    constexpr std::array names = {"left_px", "top_px", "width_px", "height_px"};
    const std::array<int, 4> most = {stack.width() - 1, stack.height() - 1, stack.width(), stack.height()};
    for (std::size_t k = 0; k < box.size(); ++k) {
      const std::optional<double> stated = given_value(document, id, names[k], image.id);
      const int least = k < 2 ? 0 : 1;
      if (!stated || !(*stated >= least) || !(*stated <= most[k]))
        throw Error(Exit::data, manifest::place(document, "/mechanisms/" + id + "/" + names[k]),
                    stated ? "is " + shortest_text(*stated) + " for image " + image.id : "is missing",
                    "a box within the picture has " + std::to_string(least) + " to " + std::to_string(most[k]));
      box[k] = std::round(*stated);
    }
    const int left = static_cast<int>(box[0]), top = static_cast<int>(box[1]);
    const int right = std::min(stack.width(), left + static_cast<int>(box[2])),
              bottom = std::min(stack.height(), top + static_cast<int>(box[3]));
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x)
        for (int c = 0; c < static_cast<int>(stack.channels.size()); ++c)
          image.counts[image.picture.index(x, y, c)] = 0;
  }
}

void conclude_moved(const Problem& problem, const Moved& moved, std::size_t candidate, Explanation& e) {
  const std::vector<std::size_t>& numbers = problem.candidates()[candidate].parameters;
  inference::Apart apart{.candidate = candidate, .estimates = {}, .p = moved.p, .effect = moved.effect};
  apart.with = moved.with, apart.without = moved.without;
  const std::size_t each = numbers.size() / moved.regions.size();
  for (std::size_t k = 0; k < moved.regions.size(); ++k) {
    const MovedRegion& r = moved.regions[k];
    const double reach = 1.96 * r.sigma;
    apart.estimates.push_back({numbers[each * k], r.relative, r.sigma, r.relative - reach, r.relative + reach, false});
    const double values[] = {r.relative, double(r.left_px), double(r.top_px), double(r.width_px), double(r.height_px)};
    for (std::size_t i = 0; i < each; ++i) {
      e.values[numbers[each * k + i]] = values[i];
      e.sigma[numbers[each * k + i]] = i == 0 ? r.sigma : r.grid_px;  // a border lies between two points of the grid
    }
  }
  inference::join(problem, apart, e);
}

std::string moved_remark(const Stack& stack, const Moved& moved) {
  std::string text;
  for (const MovedRegion& r : moved.regions)
    text += (text.empty() ? "" : "; ") + stack.images[r.image].id + ", " + inference::share_in_words(r.share) +
            " of the picture from column " + std::to_string(r.left_px) + " and row " + std::to_string(r.top_px) +
            " on, " + std::to_string(r.width_px) + " px wide and " + std::to_string(r.height_px) + " px high, " +
            (r.relative < 0 ? "darker by " : "brighter by ") + inference::share_in_words(std::abs(r.relative));
  return text.empty() ? text : "What stands there moved: " + text + ". These readings are left out.";
}

void add_moved(const Stack& stack, const Moved& moved, Illustration& result) {
  for (std::size_t k = 0; k < moved.regions.size(); ++k) {
    const MovedRegion& r = moved.regions[k];
    const StackImage& image = stack.images[r.image];
    result.boxes.push_back({image.id, r.left_px, r.top_px, r.width_px, r.height_px});
    if (k >= most_shown) continue;
    const std::size_t other = beside(stack, r.image);
    const Box part = with_surroundings(stack, r);
    std::vector<double> readings;
    for (int y = 0; y < part.height; ++y)
      for (int x = 0; x < part.width; ++x)
        for (int c = 0; c < static_cast<int>(stack.channels.size()); ++c)
          readings.push_back(image.picture.at(part.x + x, part.y + y, c));
    const double white = std::max(1e-12, stats::quantile(readings, 0.98));
    const StackImage& next = stack.images[other];
    const double gain = image.exposure_s * image.gain / (next.exposure_s * next.gain);
    result.pictures.push_back({.title = image.id + ", where something moved",
                               .png = preview(stack, r.image, part, 1, white),
                               .over_title = next.id + ", at the same exposure",
                               .over_png = preview(stack, other, part, gain, white)});
  }
}

}  // namespace gonio::explain::stacks
