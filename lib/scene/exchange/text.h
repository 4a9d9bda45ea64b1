// Numbers and matrices in the texts of scene files.
#pragma once
#include <array>
#include <string>
#include <string_view>

#include "base/text.h"
#include "geom/rigid.h"
#include "scene/exchange/lens.h"

namespace gonio::scene {

inline std::string numbers(Vec3 v, std::string_view separator = " ") {
  const std::string between(separator);
  return shortest_text(v.x) + between + shortest_text(v.y) + between + shortest_text(v.z);
}

// A 4x4 matrix, row by row: columns x, y, z, each scaled, and the origin.
struct Affine {
  std::array<Vec3, 3> column{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  Vec3 origin{};
  std::string by_rows() const {
    std::string text;
    for (int row = 0; row < 3; ++row)
      for (int c = 0; c < 4; ++c)
        text += shortest_text(c < 3 ? column[static_cast<std::size_t>(c)][row] : origin[row]) + " ";
    return text + "0 0 0 1";
  }
  std::string by_columns() const {
    std::string text;
    for (const Vec3 v : column) text += numbers(v) + " 0 ";
    return text + numbers(origin) + " 1";
  }
};
inline Affine affine_of(const Rigid<frame::World, frame::Object>& pose, Vec3 scale = {1, 1, 1}) {
  return {{pose.rotate({1, 0, 0}) * scale.x, pose.rotate({0, 1, 0}) * scale.y, pose.rotate({0, 0, 1}) * scale.z},
          pose.translation_m};
}

// Pixels by which square ones of the same fx would be off at the picture's border.
inline double square_error_px(const Lens& lens) {
  return std::abs(lens.fy / lens.fx - 1) * std::max(std::abs(lens.cy + 0.5), std::abs(lens.height - 0.5 - lens.cy));
}

}  // namespace gonio::scene
