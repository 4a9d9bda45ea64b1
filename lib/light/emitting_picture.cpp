#include "light/emitting_picture.h"

#include <cmath>

#include "base/error.h"

namespace gonio::light {

EmittingPicture::EmittingPicture(const Attachment& file, Rgb scale, const std::string& place)
    : picture_(file.picture), scale_(scale) {
  if (!picture_) throw Error(Exit::data, place, "light without its picture", "name a picture as \"file\"");
  const auto& names = picture_->channels;
  const bool rgb = names.size() >= 3 && names[0] == "R" && names[1] == "G" && names[2] == "B";
  if (picture_->pixels() == 0 || !(rgb || names.size() == 1))
    throw Error(Exit::data, place + "/file", "picture without channels R, G, B or Y", "convert it to linear RGB");
  for (const float v : picture_->data)
    if (!(v >= 0) || !std::isfinite(v))
      throw Error(Exit::data, place + "/file", "radiance is negative or not finite", "repair the picture");
}

}  // namespace gonio::light
