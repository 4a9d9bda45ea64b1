// See segmentation.h.
#include "alignment/segmentation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "alignment/segmentation_field.h"
#include "base/error.h"
#include "photograph/noise_variance.h"

namespace gonio::alignment {
namespace {

constexpr int degree = 4;         // of the ground's logarithm
constexpr int factor_degree = 2;  // of the logarithm of a picture over the empty one
constexpr int rounds = 3;         // of learning and cutting
constexpr double tie = 5;         // nats, between neighbours that look alike

std::string name_of(const std::string& place, std::size_t k) {
  return place + ", picture " + std::to_string(k + 1);
}

// Where nobody states the noise: the median difference of neighbours, which texture and rims hardly move.
double measured_sigma(const io::Image& picture, const std::vector<float>& value, std::size_t channels) {
  std::vector<float> all;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 1; x + 1 < picture.width; ++x)
      for (std::size_t c = 0; c < channels; ++c) {
        const std::size_t i =
            (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x)) *
                channels +
            c;
        all.push_back(std::abs(value[i] - 0.5f * (value[i - channels] + value[i + channels])));
      }
  if (all.empty()) return 0;
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
  return static_cast<double>(all[all.size() / 2]) / 0.6745 / std::sqrt(1.5);
}

Field field_of(std::span<const io::Image> pictures, const manifest::Noise& noise, const std::string& place) {
  Field field{pictures[0].width, pictures[0].height, colour_channels(pictures[0], name_of(place, 0)), {}, {}};
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const std::string name = pictures.size() > 1 ? name_of(place, k) : place;
    if (pictures[k].width != field.width || pictures[k].height != field.height ||
        colour_channels(pictures[k], name) != field.channels)
      throw Error(Exit::data, name, "has another size or other channels than the first", "give pictures of one camera");
    field.pictures.push_back(take_picture(pictures[k], noise, name));
  }
  return field;
}

struct Found {
  std::vector<std::uint8_t> object;
  std::vector<float> evidence;
};
// Learns and cuts in turns. `base`: the empty picture's values, or nothing.
Found find_object(Field& field, int order, std::span<const float> base) {
  const auto fit_all = [&](const Found* so_far) {
    for (std::size_t k = 0; k < field.pictures.size(); ++k)
      fit_ground(field, k, order, so_far ? lit_ground(field, k, so_far->object) : std::vector<std::uint8_t>{}, base);
  };
  const auto cut = [&](Found& found) {
    found.evidence = object_evidence(field, found.object);
    if (!base.empty()) add_texture_evidence(field, found.evidence);
    if (base.empty() && found.object.empty()) field.beyond = beyond_ground(field, found.evidence);
    found.object = cut_object(field, found.evidence, tie);
  };
  Found found;
  fit_all(nullptr);
  cut(found);
  for (int round = 0; round < rounds; ++round) fit_all(&found), cut(found);
  return found;
}

// Whether another lamp lights picture k than picture 0: ratios that are no single factor.
bool other_lamp(const Field& field, std::size_t k) {
  const LampPicture &a = field.pictures[0], &b = field.pictures[k];
  std::vector<double> ratios, noise;
  for (std::size_t i = 0; i < a.value.size(); ++i) {
    if (!(a.value[i] > 8 * a.sigma[i] && b.value[i] > 8 * b.sigma[i])) continue;
    ratios.push_back(std::log(static_cast<double>(b.value[i]) / static_cast<double>(a.value[i])));
    noise.push_back(
        std::hypot(static_cast<double>(a.sigma[i] / a.value[i]), static_cast<double>(b.sigma[i] / b.value[i])));
  }
  if (ratios.size() < 100) return true;
  std::vector<double> sorted = ratios;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double factor = *middle;
  std::size_t off = 0;
  for (std::size_t i = 0; i < ratios.size(); ++i) off += std::abs(ratios[i] - factor) > 5 * noise[i] + 0.03;
  return static_cast<double>(off) > 0.01 * static_cast<double>(ratios.size());
}

Segmentation finished(const Field& field, std::size_t k, std::span<const float> share,
                      std::span<const std::uint8_t> doubt, const std::string& place) {
  Segmentation result = labels_of(field, k, share);
  for (std::size_t p = 0; p < doubt.size(); ++p)
    if (doubt[p]) result.labels[p] = Label::unknown;
  const std::vector<Label> before = result.labels;
  clean(result);
  for (std::size_t p = 0; p < before.size(); ++p)
    if (result.labels[p] != before[p]) result.shadow_share[p] = result.labels[p] == Label::shadow ? 1.0f : 0.0f;
  check_object(result, place);
  result.certainty = certainty_of(result);
  return result;
}

Segmentation finished_alone(const Field& field, Found found, const std::string& place) {
  const std::vector<std::uint8_t> unknown = judge_dark(field, found.evidence, found.object);
  return finished(field, 0, rim_shares(field, found.object), unknown, place);
}

}  // namespace

int colour_channels(const io::Image& picture, const std::string& place) {
  if (picture.channel("R") >= 0 && picture.channel("G") >= 0 && picture.channel("B") >= 0) return 3;
  if (picture.channel("Y") >= 0) return 1;
  throw Error(Exit::data, place, "has neither R, G, B nor Y", "give a photograph");
}

LampPicture take_picture(const io::Image& picture, const manifest::Noise& noise, const std::string& place) {
  const bool colour = colour_channels(picture, place) == 3;
  const std::vector<int> from = colour
                                    ? std::vector<int>{picture.channel("R"), picture.channel("G"), picture.channel("B")}
                                    : std::vector<int>{picture.channel("Y")};
  LampPicture result;
  for (std::size_t p = 0; p < picture.pixels(); ++p)
    for (const int c : from) {
      const float v = picture.data[p * picture.channels.size() + static_cast<std::size_t>(c)];
      if (!std::isfinite(v)) throw Error(Exit::data, place, "has a pixel that is no number", "repair the picture");
      result.value.push_back(v);
    }
  const float largest = *std::max_element(result.value.begin(), result.value.end());
  if (!(largest > 0)) throw Error(Exit::data, place, "is dark everywhere", "expose longer");
  const bool stated = noise.gain > 0 || noise.read > 0;
  const double floor =
      std::max(stated ? 0.0 : measured_sigma(picture, result.value, from.size()), 1e-5 * static_cast<double>(largest));
  for (const float v : result.value)
    result.sigma.push_back(static_cast<float>(
        std::max(floor, stated ? std::sqrt(photograph::noise_variance(noise, static_cast<double>(v))) : 0.0)));
  return result;
}

std::vector<Segmentation> segment_by_lamps(std::span<const io::Image> pictures, const manifest::Noise& noise,
                                           const std::string& place) {
  if (pictures.size() < 2)
    throw Error(Exit::data, place, "fewer than two pictures", "give two or more, each under another lamp");
  Field field = field_of(pictures, noise, place);
  for (std::size_t k = 1; k < pictures.size() && !other_lamp(field, k); ++k)
    if (k + 1 == pictures.size())
      throw Error(Exit::data, place, "no two lamps differ", "light each picture from another side");
  const std::vector<float> share = rim_shares(field, find_object(field, degree, {}).object);
  std::vector<Segmentation> result;
  for (std::size_t k = 0; k < pictures.size(); ++k) result.push_back(finished(field, k, share, {}, name_of(place, k)));
  return result;
}

Segmentation segment_by_background(const io::Image& picture, const io::Image& empty, const manifest::Noise& noise,
                                   const std::string& place) {
  Field field = field_of({&picture, 1}, noise, place);
  if (empty.width != picture.width || empty.height != picture.height ||
      colour_channels(empty, place + ", empty") != field.channels)
    throw Error(Exit::data, place + ", empty", "has another size or other channels than the picture",
                "give pictures of one camera");
  LampPicture base = take_picture(empty, noise, place + ", empty");
  LampPicture& taken = field.pictures[0];
  field.beyond.assign(field.pixels(), 0);
  for (std::size_t i = 0; i < base.value.size(); ++i) {
    const bool black = base.value[i] < 8 * base.sigma[i] && taken.value[i] < 8 * taken.sigma[i];
    if (black) field.beyond[i / static_cast<std::size_t>(field.channels)] = 1;
    base.value[i] = std::max(base.value[i], 3 * base.sigma[i]);
    taken.sigma[i] = std::hypot(taken.sigma[i], base.sigma[i] * std::max(taken.value[i], 0.0f) / base.value[i]);
  }
  return finished_alone(field, find_object(field, factor_degree, base.value), place);
}

Segmentation segment_alone(const io::Image& picture, const manifest::Noise& noise, const std::string& place) {
  Field field = field_of({&picture, 1}, noise, place);
  return finished_alone(field, find_object(field, degree, {}), place);
}

}  // namespace gonio::alignment
