// From candidates to outlines: which are spheres, which are not and why.
#include "reassembly/detect.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "reassembly/detect_parts.h"

namespace gonio::reassembly {

namespace {

struct Judged {
  std::optional<CoarseOutline> coarse;
  std::optional<Outline> outline;
  std::string why;  // refused; empty with an outline: found
};

void check_wish(const io::GreyImage& picture, const camera::CameraModel& camera, const DetectWish& wish,
                const std::vector<unsigned char>& mask) {
  if (camera.orthographic())
    throw Error(Exit::data, "camera", "an orthographic camera sees a sphere under no cone",
                "give a perspective camera, or a fisheye");
  if (picture.width != camera.width_px() || picture.height != camera.height_px())
    throw Error(Exit::data, "picture",
                "has " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                    " pixels, its camera " + std::to_string(camera.width_px()) + " x " +
                    std::to_string(camera.height_px()),
                "calibrate the camera at the picture's size");
  if (!mask.empty() && mask.size() != static_cast<std::size_t>(picture.width) * picture.height)
    throw Error(Exit::data, "mask",
                "has " + std::to_string(mask.size()) + " pixels, its picture " +
                    std::to_string(static_cast<std::size_t>(picture.width) * picture.height),
                "draw it over the picture");
  if (!(wish.smallest_px >= 3 && wish.largest_px > wish.smallest_px))
    throw Error(Exit::data, "radius",
                "from " + shortest_text(wish.smallest_px) + " to " + shortest_text(wish.largest_px) +
                    " px (the smaller at least 3 and less than the larger)",
                "give the range of the outlines' radii");
  if (!(wish.least_cover >= 0.25 && wish.least_cover <= 1))
    throw Error(Exit::data, "cover", shortest_text(wish.least_cover) + " of an outline (limits 0.25 and 1)",
                "less than a quarter does not tell a circle from a bend");
}

// Where half angles are bounded, so are radii: sizes that no marker can have are not looked for at all. Over the whole
// picture, since the same cone is larger towards the rim of a pinhole's.
DetectWish narrowed(DetectWish wish, const camera::CameraModel& camera) {
  if (!wish.least_half_angle_rad && !wish.largest_half_angle_rad) return wish;
  constexpr int steps = 4;
  double least = HUGE_VAL, most = 0;
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; j <= steps; ++j) {
      const Vec2 at{double(i) * (camera.width_px() - 1) / steps, double(j) * (camera.height_px() - 1) / steps};
      const Vec3 axis = camera.ray(at).direction, across = across_of(axis);
      for (const Vec3 tangent : {across, cross(axis, across)}) {
        const auto reach = [&](double half_angle) {
          const auto rim = camera.project(axis + tangent * std::tan(half_angle));
          return rim ? norm(*rim - at) : HUGE_VAL;
        };
        if (wish.least_half_angle_rad) least = std::min(least, reach(*wish.least_half_angle_rad));
        if (wish.largest_half_angle_rad) most = std::max(most, reach(*wish.largest_half_angle_rad));
      }
    }
  if (wish.least_half_angle_rad && std::isfinite(least)) wish.smallest_px = std::max(wish.smallest_px, 0.95 * least);
  if (wish.largest_half_angle_rad && std::isfinite(most)) wish.largest_px = std::min(wish.largest_px, 1.05 * most);
  wish.largest_px = std::max(wish.largest_px, 1.01 * wish.smallest_px);
  return wish;
}

std::string two_digits(double v) {
  return shortest_text(std::round(v * 100) / 100);
}

// Why a coarse outline is none; empty: it may be one.
std::string coarse_refusal(const CoarseOutline& c, const DetectWish& wish) {
  if (c.radius_px < 0.8 * wish.smallest_px || c.radius_px > 1.1 * wish.largest_px)
    return "has a radius of " + two_digits(c.radius_px) + " px (limits " + shortest_text(wish.smallest_px) + " and " +
           shortest_text(wish.largest_px) + ")";
  const double oval_limit = std::max({0.3, 0.015 * c.radius_px, 4 * c.oval_sigma});
  if (c.oval_px > oval_limit && c.oval_gain > 0.12)
    return "is an oval: an ellipse whose semi-axes differ by " + two_digits(2 * c.oval_px) +
           " px more than a sphere's outline there (limit " + two_digits(2 * oval_limit) + ")";
  const double scale = std::exp2(c.level),
               rough = std::max((c.radius_px < small_px ? 0.6 : 0.9) * scale, 0.045 * c.radius_px);
  if (c.spread_px > rough)
    return "is no circle: its edge strays by " + two_digits(c.spread_px) + " px (limit " + two_digits(rough) + ")";
  const double asked = cover_asked(wish.least_cover, c.radius_px);
  if (c.cover < (c.radius_px < large_px ? 0.9 : 0.6) * asked)
    return "shows " + two_digits(c.cover) + " of its outline (limit " + two_digits(asked) + ")";
  return {};
}

std::string fine_refusal(const Outline& o, const DetectWish& wish) {
  if (o.radius_px < wish.smallest_px || o.radius_px > wish.largest_px)
    return "has a radius of " + two_digits(o.radius_px) + " px (limits " + shortest_text(wish.smallest_px) + " and " +
           shortest_text(wish.largest_px) + ")";
  const double low = wish.least_half_angle_rad.value_or(0), high = wish.largest_half_angle_rad.value_or(pi);
  if (o.half_angle_rad < low || o.half_angle_rad > high)
    return "is seen under a half angle of " + shortest_text(o.half_angle_rad) + " rad (limits " + shortest_text(low) +
           " and " + shortest_text(high) + ")";
  const double asked = cover_asked(wish.least_cover, o.radius_px);
  if (o.cover < asked) return "shows " + two_digits(o.cover) + " of its outline (limit " + two_digits(asked) + ")";
  const double rough = std::max(0.25, 0.025 * o.radius_px);
  if (o.rms_px > rough)
    return "is no circle: its edge strays by " + two_digits(o.rms_px) + " px (limit " + two_digits(rough) + ")";
  if (o.contrast < wish.least_contrast)
    return "stands out by " + two_digits(o.contrast) + " times the noise (limit " + shortest_text(wish.least_contrast) +
           ")";
  return {};
}

bool same_outline(const Cone& a, const Cone& b) {
  const double size = std::min(a.half_angle_rad, b.half_angle_rad);
  return norm(a.axis - b.axis) < 0.25 * size && std::abs(a.half_angle_rad - b.half_angle_rad) < 0.15 * size;
}

Cone cone_of_outline(const Outline& o) {
  return {o.axis, o.half_angle_rad};
}

// `inner` lies within `outer`, rims touching allowed.
bool lies_within(const Outline& inner, const Outline& outer) {
  const double apart = 2 * std::asin(std::min(1.0, norm(inner.axis - outer.axis) / 2));
  return inner.half_angle_rad < outer.half_angle_rad && apart + 0.8 * inner.half_angle_rad < outer.half_angle_rad;
}

// A circle within a circle is a highlight, a ring or a picture on a ball. But one circle that holds three markers or
// more, and is the only one of its size that does, is a round thing with markers on it.
void sort_out_contained(std::vector<Outline>& found, std::vector<Refused>& refused) {
  const std::size_t n = found.size();
  std::vector<std::size_t> holds(n, 0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) holds[i] += i != j && lies_within(found[j], found[i]);
  std::vector<bool> out(n, false);
  constexpr std::size_t several = 3;
  for (std::size_t i = 0; i < n; ++i) {
    if (holds[i] < several) continue;
    bool alone = true;
    for (std::size_t j = 0; j < n; ++j)
      alone = alone &&
              (j == i || holds[j] == 0 || std::abs(std::log(found[j].half_angle_rad / found[i].half_angle_rad)) > 0.3);
    if (!alone) continue;
    out[i] = true;
    refused.push_back({found[i].centre_px, found[i].radius_px,
                       "holds " + std::to_string(holds[i]) + " other outlines: a round thing with markers on it"});
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n && !out[i]; ++j) {
      if (i == j || out[j] || !lies_within(found[i], found[j])) continue;
      out[i] = true;
      refused.push_back({found[i].centre_px, found[i].radius_px,
                         "lies within the outline at " + two_digits(found[j].centre_px.x) + ", " +
                             two_digits(found[j].centre_px.y) + ": a highlight or a ring"});
    }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (!out[i]) found[kept++] = found[i];
  found.resize(kept);
}

template <class T>
void from_top_to_bottom(std::vector<T>& all) {
  std::sort(all.begin(), all.end(), [](const T& a, const T& b) {
    return a.centre_px.y != b.centre_px.y ? a.centre_px.y < b.centre_px.y : a.centre_px.x < b.centre_px.x;
  });
}

std::vector<Judged> follow(const Pyramid& pyramid, const camera::CameraModel& camera, const DetectWish& wish,
                           const std::vector<OutlineCandidate>& candidates) {
  std::vector<Judged> judged(candidates.size());
  parallel_for(0, candidates.size(), [&](std::size_t i) {
    judged[i].coarse = coarse_outline(pyramid, camera, candidates[i]);
    if (judged[i].coarse) judged[i].why = coarse_refusal(*judged[i].coarse, wish);
  });
  // Candidates that came to the same outline are one; the roughly best covered stands for them.
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < judged.size(); ++i)
    if (judged[i].coarse) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(!judged[a].why.empty(), -judged[a].coarse->cover) <
           std::pair(!judged[b].why.empty(), -judged[b].coarse->cover);
  });
  std::vector<std::size_t> kept;
  for (const std::size_t i : order)
    if (std::none_of(kept.begin(), kept.end(),
                     [&](std::size_t k) { return same_outline(judged[i].coarse->cone, judged[k].coarse->cone); }))
      kept.push_back(i);
  parallel_for(0, kept.size(), [&](std::size_t k) {
    Judged& j = judged[kept[k]];
    if (!j.why.empty()) return;
    j.outline = fine_outline(pyramid, camera, wish.least_cover, *j.coarse);
    j.why = j.outline ? fine_refusal(*j.outline, wish) : "its grey values do not determine an outline";
  });
  std::vector<Judged> result;
  for (const std::size_t i : kept) result.push_back(std::move(judged[i]));
  return result;
}

}  // namespace

Detected detect_spheres(const io::GreyImage& picture, const camera::CameraModel& camera, const DetectWish& asked,
                        const std::vector<unsigned char>& mask) {
  check_wish(picture, camera, asked, mask);
  const DetectWish wish = narrowed(asked, camera);
  const Pyramid pyramid = pyramid_of(picture, mask, wish.largest_px);
  const std::vector<OutlineCandidate> candidates = circle_candidates(pyramid, camera, wish);
  std::vector<Judged> judged = follow(pyramid, camera, wish, candidates);
  Detected result;
  std::stable_sort(judged.begin(), judged.end(), [](const Judged& a, const Judged& b) {
    return (a.outline ? a.outline->cover : 0) > (b.outline ? b.outline->cover : 0);
  });
  for (const Judged& j : judged) {
    if (j.why.empty()) {
      const Cone cone = cone_of_outline(*j.outline);
      if (std::none_of(result.found.begin(), result.found.end(),
                       [&](const Outline& o) { return same_outline(cone_of_outline(o), cone); }))
        result.found.push_back(*j.outline);
    } else if (const auto centre = camera.project(j.coarse->cone.axis); centre) {
      result.refused.push_back({*centre, j.coarse->radius_px, j.why});
    }
  }
  sort_out_contained(result.found, result.refused);
  from_top_to_bottom(result.found);
  from_top_to_bottom(result.refused);
  return result;
}

}  // namespace gonio::reassembly
