// A photograph into regions: evidence of pixels, mixed pixels taken apart, a random field, watershed into what is left.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "reassembly/label_evidence.h"
#include "reassembly/label_field.h"

namespace gonio::reassembly {
namespace {

// The field's marginals count errors of neighbouring pixels as independent, which they are not (a highlight, a shadow
// that the shading has elsewhere): their logarithms are divided by this. Set on simulated scenes so that confidence is
// a frequency; tests/reassembly holds it against others.
constexpr float marginal_temper = 0.5f;
constexpr float knows_itself = 0.6f;  // confidence below which a pixel is flooded from its neighbours

void check_wish(const io::Image& picture, const std::vector<std::uint8_t>& clipped, const LabelWish& wish) {
  const auto refuse = [](const char* place, const std::string& problem, const char* remedy) {
    throw Error(Exit::data, place, problem, remedy);
  };
  const std::string pixels = std::to_string(picture.pixels());
  if (picture.pixels() == 0) refuse("the photograph", "has no pixels", "give another");
  if (!clipped.empty() && clipped.size() != picture.pixels())
    refuse("the saturated pixels", std::to_string(clipped.size()) + " for " + pixels + " pixels", "give one each");
  if (!wish.seeds.empty() && wish.seeds.size() != picture.pixels())
    refuse("the seeds", std::to_string(wish.seeds.size()) + " for " + pixels + " pixels", "give one each");
  if (wish.from_seeds_only && wish.seeds.empty()) refuse("the seeds", "there are none", "give some for every region");
  if (!(wish.noise_gain >= 0) || !(wish.noise_read >= 0) || !(wish.shading_spread > 0) || !(wish.shading_lack >= 0))
    refuse("the noise", "is negative or no number", "give standard deviations");
  for (const Material& m : wish.materials)
    if (!is_finite(m.albedo) || !(std::min({m.albedo.x, m.albedo.y, m.albedo.z}) >= 0) ||
        !(max_component(m.albedo) > 0))
      refuse(m.surface.c_str(), "its albedo is not positive", "give linear colour");
  for (const std::int32_t seed : wish.seeds)
    if (seed < unlabelled || (!wish.materials.empty() && seed >= static_cast<std::int32_t>(wish.materials.size())))
      refuse("the seeds",
             "one names material " + std::to_string(seed) + ", of " + std::to_string(wish.materials.size()),
             "seeds are indices into the materials");
}

LabelColour colour_of(const Material& material, std::int32_t label) {
  // Black sends nothing; a tenth of a percent keeps its logarithms finite.
  const auto channel = [](double v) { return static_cast<float>(std::max(v, 1e-3)); };
  return {{channel(material.albedo.x), channel(material.albedo.y), channel(material.albedo.z)},
          static_cast<float>(std::max(material.spread, 0.005)),
          label};
}

// Multiples of the golden ratio are spread evenly over a picture whatever its width (Weyl).
std::size_t some(std::size_t k, std::size_t pixels) {
  const double turn = 0.6180339887498949 * static_cast<double>(k + 1);
  return std::min(pixels - 1, static_cast<std::size_t>((turn - std::floor(turn)) * static_cast<double>(pixels)));
}

// Some of a picture's pixels, side by side.
io::Image some_of(const io::Image& picture, std::size_t count) {
  io::Image few(static_cast<int>(count), 1, picture.channels);
  const std::size_t stride = picture.channels.size();
  for (std::size_t k = 0; k < count; ++k)
    std::copy_n(picture.data.begin() + static_cast<std::ptrdiff_t>(some(k, picture.pixels()) * stride), stride,
                few.data.begin() + static_cast<std::ptrdiff_t>(k * stride));
  return few;
}

// Albedos as this picture has them: what was measured elsewhere, and what interfaces add everywhere, is off by a
// little. The median of the pixels that are surely a material's, a third of a logarithm at most.
void adapt(std::vector<LabelColour>& colours, const io::Image& picture, const std::vector<std::uint8_t>& clipped,
           const LabelWish& wish, std::int32_t labels) {
  if (wish.shading.data.empty()) return;
  const std::size_t count = std::min<std::size_t>(20000, picture.pixels());
  LabelWish small = wish;
  small.shading = some_of(wish.shading, count);
  if (!wish.highlight.data.empty()) small.highlight = some_of(wish.highlight, count);
  const io::Image few = some_of(picture, count);
  std::vector<std::uint8_t> few_clipped;
  for (std::size_t k = 0; k < count && !clipped.empty(); ++k) few_clipped.push_back(clipped[some(k, picture.pixels())]);
  const Evidence evidence = evidence_of(few, few_clipped, small, colours, labels);
  const Tones values(few, "the photograph"), lights(small.shading, "the shading");
  const Tone usual = lights.mean();
  for (LabelColour& colour : colours) {
    std::array<std::vector<float>, 3> logs;
    for (std::size_t i = 0; i < count; ++i) {
      const float* log = evidence.of(i);
      const auto sure = std::count_if(log, log + labels, [](float v) { return v > -3; }) == 1;
      const Tone v = values(i), s = lights(i);
      if (!sure || log[colour.label] < 0 || !(s[1] > 0.3f * usual[1])) continue;
      for (std::size_t c = 0; c < 3; ++c) logs[c].push_back(std::log(std::max(v[c], 1e-6f) / std::max(s[c], 1e-6f)));
    }
    const auto found = static_cast<float>(logs[0].size());
    if (found == 0) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto middle = logs[c].begin() + static_cast<std::ptrdiff_t>(logs[c].size() / 2);
      std::nth_element(logs[c].begin(), middle, logs[c].end());
      const float step = std::clamp(*middle - std::log(colour.albedo[c]), -0.33f, 0.33f);
      colour.albedo[c] *= std::exp(step * found / (found + 50));
    }
  }
}

// What each seed covers, as several colours of one label.
std::vector<LabelColour> colours_under_seeds(const LitPicture& lit, const LabelWish& wish, std::int32_t labels) {
  std::vector<LabelColour> colours;
  for (std::int32_t label = 0; label < labels; ++label) {
    std::vector<std::uint8_t> counts(wish.seeds.size());
    std::transform(wish.seeds.begin(), wish.seeds.end(), counts.begin(),
                   [&](std::int32_t seed) -> std::uint8_t { return seed == label ? 1 : 0; });
    if (std::find(counts.begin(), counts.end(), 1) == counts.end()) continue;
    for (const Material& material : cluster({&lit, 1}, wish.most_materials, counts))
      colours.push_back(colour_of(material, label));
  }
  return colours;
}

// Contrast of two pixels as the eye of a watershed sees it: 0 alike, 1 different, of the light divided out.
class Contrasts {
 public:
  Contrasts(const io::Image& picture, const LabelWish& wish) : values_(picture, "the photograph") {
    if (!wish.shading.data.empty()) shading_ = {wish.shading, "the shading"};
  }
  float operator()(std::size_t a, std::size_t b) const {
    const Tone one = tone(a), other = tone(b);
    float square = 0, grey = 0;
    Tone step{};  // of the logarithm, to third order: log x - log y = 2 (x - y) / (x + y)
    for (std::size_t c = 0; c < 3; ++c) grey += (step[c] = 2 * (one[c] - other[c]) / (one[c] + other[c] + 0.02f)) / 3;
    for (std::size_t c = 0; c < 3; ++c) {
      const float rest = shading_.known() ? step[c] : step[c] - 0.7f * grey;  // a shadow's border is a grey one
      square += rest * rest;
    }
    const float length = std::sqrt(square);
    return length / (length + 0.5f);
  }

 private:
  Tone tone(std::size_t i) const {
    Tone v = values_(i);
    for (float& c : v) c = std::max(c, 0.0f);
    if (!shading_.known()) return v;
    const Tone s = shading_(i);
    for (std::size_t c = 0; c < 3; ++c) v[c] /= std::max(s[c], 1e-4f);
    return v;
  }
  Tones values_, shading_;
};

// Mean distance that a straight line runs within one label: pi area / (2 border) (Crofton's formula), pixels.
float mean_run(const LabelPicture& labels) {
  double borders = 0;
  for (int y = 0; y < labels.height; ++y)
    for (int x = 0; x < labels.width; ++x) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(labels.width) + static_cast<std::size_t>(x);
      const auto differs = [&](std::size_t j) {
        return labels.label[i] >= 0 && labels.label[j] >= 0 && labels.label[i] != labels.label[j];
      };
      borders += (x + 1 < labels.width && differs(i + 1) ? 1 : 0) +
                 (y + 1 < labels.height && differs(i + static_cast<std::size_t>(labels.width)) ? 1 : 0);
    }
  // Steps between pixels overstate the length of a border at random angles by 4 / pi.
  return static_cast<float>(pi * static_cast<double>(labels.label.size()) / (2 * std::max(1.0, borders * pi / 4)));
}

// The lower of what the pixel says and what the way to it lost.
void flood_unknown(LabelPicture& labels, const Evidence& evidence, const Contrasts& contrasts, const LabelWish& wish) {
  const float run = mean_run(labels), even = 1 / static_cast<float>(std::max(2, evidence.labels));
  if (wish.from_seeds_only) labels.label = wish.seeds;
  const std::vector<std::int32_t> before = labels.label;
  // Towards the marginals, too: into a region that looks like another material the way is dear. Seeds alone name parts
  // of a picture that may have any colours, which says nothing of what they do not cover.
  const float named = wish.materials.empty() && !wish.seeds.empty() ? 0 : 0.5f;
  const auto length =
      flood(labels.width, labels.height, labels.label, [&](std::size_t a, std::size_t b, std::int32_t k) {
        const float against = 1 - std::exp(marginal_temper * evidence.of(b)[k]);
        return (1 - named) * contrasts(a, b) + named * against;
      });
  for (std::size_t i = 0; i < labels.label.size(); ++i) {
    if (before[i] != unlabelled || labels.label[i] == unlabelled) continue;
    const float kept = wish.from_seeds_only ? 1 : std::exp(-static_cast<float>(length[i]) / run);
    const float agrees = wish.from_seeds_only ? std::exp(marginal_temper * evidence.of(i)[labels.label[i]]) : 1;
    labels.confidence[i] = even + (1 - even) * kept * (0.5f + 0.49f * agrees);
  }
}

}  // namespace

LabelPicture label_picture(const io::Image& picture, const std::vector<std::uint8_t>& clipped, const LabelWish& wish) {
  check_wish(picture, clipped, wish);
  const LitPicture lit{&picture, &clipped, wish.shading.data.empty() ? nullptr : &wish.shading};
  std::vector<LabelColour> colours;
  std::int32_t labels = 0;
  if (wish.materials.empty() && !wish.seeds.empty()) {
    labels = 1 + *std::max_element(wish.seeds.begin(), wish.seeds.end());
    colours = colours_under_seeds(lit, wish, labels);
  } else {
    for (const Material& m : wish.materials.empty() ? find_materials({&lit, 1}, wish.most_materials) : wish.materials)
      colours.push_back(colour_of(m, labels++));
  }
  if (colours.empty()) throw Error(Exit::data, "the seeds", "there are none", "seed every material, or name none");
  if (!wish.materials.empty()) adapt(colours, picture, clipped, wish, labels);
  Evidence evidence = evidence_of(picture, clipped, wish, colours, labels);
  unmix(evidence, picture, wish);
  smooth(evidence, wish.seeds);
  LabelPicture result{picture.width, picture.height, std::vector<std::int32_t>(picture.pixels(), unlabelled),
                      std::vector<float>(picture.pixels(), 0)};
  const auto row = static_cast<std::size_t>(picture.width);
  parallel_for(0, static_cast<std::size_t>(picture.height), [&](std::size_t y) {
    for (std::size_t i = y * row; i < (y + 1) * row; ++i) {
      const float* log = evidence.of(i);
      float sum = 0;
      for (std::int32_t k = 0; k < labels; ++k) sum += std::exp(marginal_temper * log[k]);
      result.confidence[i] = 1 / sum;
      if (result.confidence[i] >= knows_itself) result.label[i] = evidence.best(i);
    }
  });
  flood_unknown(result, evidence, Contrasts(picture, wish), wish);
  for (std::size_t i = 0; i < wish.seeds.size(); ++i)
    if (wish.seeds[i] >= 0) {
      result.label[i] = wish.seeds[i];
      result.confidence[i] = 1;
    }
  return result;
}

}  // namespace gonio::reassembly
