#include "report/colour_map.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <span>

#include "geom/luminance.h"

namespace gonio::report {
namespace {

constexpr Colour not_a_number{1, 0, 1};

constexpr std::array<std::uint32_t, 11> viridis{0x440154, 0x482475, 0x414487, 0x355f8d, 0x2a788e, 0x21918c,
                                                0x22a884, 0x44bf70, 0x7ad151, 0xbddf26, 0xfde725};
constexpr std::array<std::uint32_t, 11> blue_white_red{0x053061, 0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7,
                                                       0xfddbc7, 0xf4a582, 0xd6604d, 0xb2182b, 0x67001f};

Colour unpack(std::uint32_t rgb) {
  return {static_cast<float>((rgb >> 16) & 255u) / 255.0f, static_cast<float>((rgb >> 8) & 255u) / 255.0f,
          static_cast<float>(rgb & 255u) / 255.0f};
}

Colour interpolate(std::span<const std::uint32_t> points, double t) {
  const double at = std::clamp(t, 0.0, 1.0) * static_cast<double>(points.size() - 1);
  const std::size_t left = std::min(static_cast<std::size_t>(at), points.size() - 2);
  const auto share = static_cast<float>(at - static_cast<double>(left));
  const Colour a = unpack(points[left]), b = unpack(points[left + 1]);
  return {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])};
}

}  // namespace

Colour magnitude_colour(double t) {
  return std::isnan(t) ? not_a_number : interpolate(viridis, t);
}

Colour signed_colour(double t) {
  return std::isnan(t) ? not_a_number : interpolate(blue_white_red, (t + 1) / 2);
}

std::string hex(Colour colour) {
  const auto code = [](float v) { return static_cast<unsigned>(std::lround(std::clamp(v, 0.0f, 1.0f) * 255.0f)); };
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", code(colour[0]) & 255u, code(colour[1]) & 255u,
                code(colour[2]) & 255u);
  return text;
}

bool is_dark(Colour colour) {
  return luminance_of(colour[0], colour[1], colour[2]) < 0.45f;  // of the codes, not of their light
}

}  // namespace gonio::report
