// The masks of one photograph as regions: whose rim runs where, and what hides it. Private to alignment/.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "alignment/observed_rim.h"
#include "manifest/sections/forward.h"

namespace gonio::alignment {

class MaskRegions {
 public:
  struct Mask {
    std::size_t outline = 0;
    std::string object, place;  // for messages
    bool shadow = false;
    std::vector<float> share;  // of each pixel
    bool binary = true;
    std::vector<std::uint8_t> unknown{};  // 1 per pixel of which nobody can tell; or empty
  };
  MaskRegions(int width, int height, std::vector<Mask> masks);

  // Points of the rim of outline `outline`, in the picture's own pixels. Binary masks are smoothed by `smooth_px`,
  // others by half of that. `whole`: Error(data) where the picture's border cuts the mask. Error(data) for empty masks.
  std::vector<RimPoint> rim(std::size_t outline, double smooth_px, bool whole) const;
  double smoothed_by(std::size_t outline, double smooth_px) const {
    return mask(outline).binary ? smooth_px : 0.5 * smooth_px;
  }
  const std::vector<Mask>& masks() const { return masks_; }
  int width() const { return width_; }
  int height() const { return height_; }
  // Could no rim of that outline be seen at `pixel`: beyond the picture, or beneath an object's mask?
  bool hides(std::size_t outline, Vec2 pixel) const;

 private:
  const Mask& mask(std::size_t outline) const;
  bool covers(const Mask& own, const Mask& other) const;
  int width_, height_;
  std::vector<Mask> masks_;
  std::map<std::size_t, std::vector<std::uint8_t>> near_;  // by outline: within the margin of what covers it
};

// All masks that the manifest has of an image.
MaskRegions read_regions(const manifest::Document& document, const std::string& image,
                         const std::function<void(const std::filesystem::path&)>& note);

}  // namespace gonio::alignment
