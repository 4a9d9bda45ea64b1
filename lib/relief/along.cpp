// See along.h.
#include "relief/along.h"

#include "base/error.h"

namespace gonio::relief {

double pixel_share(const io::GreyImage& picture, int x, int y, double beyond) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return beyond;
  const std::size_t k =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x);
  const double code = picture.values.empty() ? picture.bytes[k] : static_cast<double>(picture.values[k]);
  return std::clamp(code / 255, 0.0, 1.0);
}

Vec2 in_pixels(const io::GreyImage& picture, Vec2 along_m, double pixel_m) {
  constexpr double far = 1e9;  // where a whole number would not hold it
  return {std::clamp(along_m.x / pixel_m + (picture.width - 1) / 2.0, -far, far),
          std::clamp((picture.height - 1) / 2.0 - along_m.y / pixel_m, -far, far)};
}

TurnByCells::TurnByCells(double rad, const io::GreyImage* picture, double cell_m, const std::string& place)
    : turn_(rad), picture_(picture), cell_m_(cell_m) {
  if (picture != nullptr && !(cell_m > 0))
    throw Error(Exit::data, place + "/cell_m", "is missing beside a file", "say how large a pixel of the picture is");
}

Vec2 TurnByCells::operator()(Vec2 p) const {
  const Vec2 turned = turn_(p);
  if (picture_ == nullptr) return turned;
  const Vec2 at = in_pixels(*picture_, p, cell_m_);
  const bool white = pixel_share(*picture_, static_cast<int>(std::floor(at.x + 0.5)),
                                 static_cast<int>(std::floor(at.y + 0.5)), 0) > 0.5;
  return white ? Vec2{turned.y, -turned.x} : turned;
}

}  // namespace gonio::relief
