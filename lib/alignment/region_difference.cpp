// See region_difference.h.
#include "alignment/region_difference.h"

#include <algorithm>
#include <cstdint>

#include "alignment/model_region.h"
#include "base/error.h"
#include "base/text.h"
#include "report/colour_map.h"

namespace gonio::alignment {
namespace {

enum class Pixel : std::uint8_t { ground, unknown, shadow, object, missed, beyond };  // later ones hide earlier ones

report::Colour colour_of(Pixel pixel) {
  switch (pixel) {
    case Pixel::ground: return {1, 1, 1};
    case Pixel::unknown: return {0.94F, 0.94F, 0.94F};
    case Pixel::shadow: return {0.84F, 0.84F, 0.84F};
    case Pixel::object: return {0.68F, 0.68F, 0.68F};
    case Pixel::missed: return report::signed_colour(-0.8);
    default: return report::signed_colour(0.8);
  }
}

// Shares that the setting covers; zeros where the subject has no rim.
std::vector<float> region_of(const AlignmentInput& in, const Setting& setting, const RimSubject& subject,
                             std::size_t pixels) {
  return ModelRim(setting, subject).exists() ? model_region(in, setting, subject) : std::vector<float>(pixels, 0);
}

class Comparison {
 public:
  Comparison(const AlignmentInput& in, const MaskRegions& regions, const Setting& setting)
      : in_(in),
        regions_(regions),
        setting_(setting),
        pixels_(static_cast<std::size_t>(regions.width()) * static_cast<std::size_t>(regions.height())),
        shown_(pixels_, Pixel::ground) {}

  void add(std::size_t rim) {
    const RimSubject& subject = in_.question.sightings[rim].subject;
    std::vector<float> model = region_of(in_, setting_, subject, pixels_);
    if (subject.lamp)  // beneath the objects nobody sees it
      for (std::size_t b = 0; b < setting_.bodies.size(); ++b) {
        const std::vector<float> over = region_of(in_, setting_, {subject.station, b, {}}, pixels_);
        for (std::size_t i = 0; i < pixels_; ++i) model[i] = std::min(model[i], 1 - over[i]);
      }
    const MaskRegions::Mask& own = mask_of(rim);
    MaskMatch match{.what = (own.shadow ? "shadow of " : "") + own.object};
    const std::vector<std::uint8_t> blind = hidden(own);
    for (std::size_t i = 0; i < pixels_; ++i) {
      if (blind[i]) {
        show(i, Pixel::unknown);
        continue;
      }
      const bool seen = own.share[i] > 0.5F, made = model[i] > 0.5F;
      ++match.compared;
      match.both += seen && made, match.missed += seen && !made, match.beyond += made && !seen;
      if (seen || made)
        show(i, seen != made ? (seen ? Pixel::missed : Pixel::beyond) : own.shadow ? Pixel::shadow : Pixel::object);
    }
    masks_.push_back(std::move(match));
  }
  const std::vector<Pixel>& shown() const { return shown_; }
  const std::vector<MaskMatch>& masks() const { return masks_; }

 private:
  void show(std::size_t i, Pixel pixel) { shown_[i] = std::max(shown_[i], pixel); }
  const MaskRegions::Mask& mask_of(std::size_t rim) const {
    for (const MaskRegions::Mask& m : regions_.masks())
      if (m.outline == in_.rims[rim].outline) return m;
    throw Error(Exit::internal, "outlines", "lost a mask");
  }
  std::vector<std::uint8_t> hidden(const MaskRegions::Mask& own) const {
    std::vector<std::uint8_t> blind(pixels_, 0);
    for (const MaskRegions::Mask& other : regions_.masks()) {
      const bool over = !other.shadow && (own.shadow || other.object != own.object);
      for (std::size_t i = 0; i < pixels_; ++i)
        if ((over && other.share[i] > 0.5F) || (!other.unknown.empty() && other.unknown[i])) blind[i] = 1;
    }
    return blind;
  }

  const AlignmentInput& in_;
  const MaskRegions& regions_;
  const Setting& setting_;
  std::size_t pixels_;
  std::vector<Pixel> shown_;
  std::vector<MaskMatch> masks_;
};

struct Part {  // of the picture: both ends inside
  int left, top, right, bottom;
};
// What all comparisons show, with some pixels around it.
Part part_shown(const std::vector<Comparison>& all, int width, int height) {
  constexpr int around = 8;
  Part part{width, height, -1, -1};
  for (const Comparison& one : all)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (one.shown()[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] >
            Pixel::unknown)
          part = {std::min(part.left, x), std::min(part.top, y), std::max(part.right, x), std::max(part.bottom, y)};
  if (part.right < 0) return {0, 0, width - 1, height - 1};
  return {std::max(0, part.left - around), std::max(0, part.top - around), std::min(width - 1, part.right + around),
          std::min(height - 1, part.bottom + around)};
}

io::Image drawn(const std::vector<Pixel>& shown, int width, const Part& part) {
  io::Image picture(part.right - part.left + 1, part.bottom - part.top + 1, {"R", "G", "B"});
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto i = static_cast<std::size_t>(y + part.top) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x + part.left);
      const report::Colour colour = colour_of(shown[i]);
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = colour[static_cast<std::size_t>(c)];
    }
  return picture;
}

}  // namespace

std::vector<RegionDifference> region_differences(const AlignmentInput& in, const std::vector<std::size_t>& rims,
                                                 const MaskRegions& regions, const std::vector<Setting>& settings) {
  std::vector<Comparison> all;
  for (const Setting& setting : settings) {
    all.emplace_back(in, regions, setting);
    for (const std::size_t rim : rims) all.back().add(rim);
  }
  const Part part = part_shown(all, regions.width(), regions.height());
  std::vector<RegionDifference> out;
  for (const Comparison& one : all) out.push_back({drawn(one.shown(), regions.width(), part), one.masks()});
  return out;
}

std::string words_of(const RegionDifference& difference) {
  std::string words;
  for (const MaskMatch& m : difference.masks)
    words += (words.empty() ? "" : "; ") + m.what +
             format(": %.2f %% of the pixels wrong, IoU %.3f", 100 * m.wrong(), m.overlap());
  return words;
}

}  // namespace gonio::alignment
