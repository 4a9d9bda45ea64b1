// Pictures that shine: linear radiance in channels R, G, B (or one channel, which is white).
#pragma once
#include <memory>
#include <string>

#include "geom/luminance.h"
#include "geom/vector.h"
#include "light/light.h"

namespace gonio::light {

class EmittingPicture {
 public:
  // Error(data) at `place` for a missing picture, other channels, and values that are negative or not finite.
  EmittingPicture(const Attachment& file, Rgb scale, const std::string& place);
  std::size_t columns() const { return static_cast<std::size_t>(picture_->width); }
  std::size_t rows() const { return static_cast<std::size_t>(picture_->height); }
  Rgb radiance(std::size_t x, std::size_t y) const {
    const std::size_t channels = picture_->channels.size();
    const float* pixel = picture_->data.data() + (y * columns() + x) * channels;
    return channels >= 3 ? Rgb{pixel[0], pixel[1], pixel[2]} * scale_ : scale_ * double{pixel[0]};
  }
  // For sampling: Rec. 709 luminance, positive wherever a band is.
  double importance(std::size_t x, std::size_t y) const { return luminance_of(radiance(x, y)); }

 private:
  std::shared_ptr<const io::Image> picture_;
  Rgb scale_;
};

}  // namespace gonio::light
