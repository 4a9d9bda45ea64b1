// What segmentation by models of the ground works on: pictures with what the bare, lit ground would show in each, and
// the steps that turn them into labels. Private to alignment/.
//
// Values are linear radiance. A "picture" here is one photograph of the place; all share camera, place and size, and
// each has its own lamp. "Ratio" is value over lit ground: 1 on lit ground, less in shadow, anything on an object.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "alignment/segmentation.h"
#include "io/image.h"
#include "manifest/noise.h"

namespace gonio::alignment {

struct LampPicture {
  std::vector<float> value;       // pixel * channels + channel
  std::vector<float> sigma;       // of value: the camera's noise
  std::vector<float> ground;      // of lit ground, the same layout; 0: not fitted yet
  std::vector<float> brightness;  // per pixel: mean over the channels of the ratio's logarithm
  std::vector<float> spread;      // per pixel: standard deviation of that by noise and model
  double model_error = 0.01;      // relative: of lit ground about its model, beyond noise
};

struct Field {
  int width = 0, height = 0, channels = 0;
  std::vector<LampPicture> pictures;
  std::vector<std::uint8_t> beyond;  // 1 per pixel past the ground's edge, or empty
  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

// Calls visit(q) for the pixels within `far` of p: a square, cut off at the border.
template <class Visit>
void around(const Field& field, std::size_t p, int far, const Visit& visit) {
  const auto w = static_cast<std::size_t>(field.width);
  const int x = static_cast<int>(p % w), y = static_cast<int>(p / w);
  for (int j = std::max(0, y - far); j <= std::min(field.height - 1, y + far); ++j)
    for (int i = std::max(0, x - far); i <= std::min(field.width - 1, x + far); ++i)
      visit(static_cast<std::size_t>(j) * w + static_cast<std::size_t>(i));
}

// Colour or grey channels of a picture, checked; Error(data) naming `place` where they are missing or not finite.
LampPicture take_picture(const io::Image& picture, const manifest::Noise& noise, const std::string& place);
int colour_channels(const io::Image& picture, const std::string& place);

// The lit ground of picture k as exp(polynomial of the pixel), per channel, robust: pixels of `lit` only where that is
// given (1 per pixel that is lit ground), else whatever more than half of the pixels agree on. `base`: what the
// polynomial multiplies, of the layout of `value`; empty: 1. Sets ground, brightness, spread and model_error.
void fit_ground(Field& field, std::size_t k, int degree, std::span<const std::uint8_t> lit,
                std::span<const float> base);

// 1 per pixel past the ground's edge, where the place is dark in every picture: parts that come in from the border
// without touching what surely is an object, and two pixels about them.
std::vector<std::uint8_t> beyond_ground(const Field& field, std::span<const float> evidence);

// 1 per pixel of the object: the cheapest cut between what each pixel says by itself (`evidence`: log likelihood of
// object over ground) and what tears neighbours apart that look alike.
std::vector<std::uint8_t> cut_object(const Field& field, std::span<const float> evidence, double tie);

// Evidence by densities that are learned from the labels so far (object: 1 per pixel); empty: from what only one can
// be.
std::vector<float> object_evidence(const Field& field, std::span<const std::uint8_t> object);

// Adds what the ground's texture says of dark pixels, where `ground` has it: of an empty picture.
void add_texture_evidence(const Field& field, std::vector<float>& evidence);

// Of one picture: what dark pixels are whose colour and texture do not tell a shadow from the object's own dark side.
// Those that brightness joins to the object's lit side without a step are its own: object while they are hardly dark,
// further unknown, for the same way may lead on into the shadow. Others are shadow where they meet lit ground and are
// about as dark as the darkest that do, and else unknown. Changes `object`; gives 1 per unknown pixel.
std::vector<std::uint8_t> judge_dark(const Field& field, std::span<const float> evidence,
                                     std::vector<std::uint8_t>& object);

// 1 per pixel and picture: ground that would be lit by the ratio alone, judged pixel by pixel.
std::vector<std::uint8_t> lit_ground(const Field& field, std::size_t k, std::span<const std::uint8_t> object);

// Shares of the object in pixels at its rim, by mixing of what lies two and three pixels to either side; 0 or 1
// elsewhere.
std::vector<float> rim_shares(const Field& field, std::span<const std::uint8_t> object);

// Labels of picture k: the object where its share exceeds a half, shadow where the ground's own ratio lies below the
// middle between lit ground and the shadow nearby.
Segmentation labels_of(const Field& field, std::size_t k, std::span<const float> share);

// Labels that fewer than three of the eight neighbours share go to the majority of the 3x3 pixels about them.
void clean(Segmentation& segmentation);
void check_object(const Segmentation& segmentation,
                  const std::string& place);  // Error(data): none, or it meets the border
double certainty_of(const Segmentation& segmentation);

}  // namespace gonio::alignment
