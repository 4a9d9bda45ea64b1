// See ball_outline.h.
#include "probe/ball_outline.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "io/grey.h"
#include "probe/mirror_outline.h"
#include "reassembly/ball_place.h"
#include "reassembly/detect.h"
#include "stats/intervals.h"

namespace gonio::probe {
namespace {

using reassembly::Outline;

// Shares of an outline at which an edge lies, with and without a circle that says where to look.
constexpr double least_cover = 0.3, least_cover_alone = 0.5;

// Compressed as the header says; the first three channels count alike.
io::GreyImage compressed(const io::Image& picture, const std::vector<unsigned char>& counts) {
  const std::size_t channels = picture.channels.size(), used = channels >= 3 ? 3 : 1;
  std::vector<double> light(picture.pixels()), middle;
  for (std::size_t i = 0; i < light.size(); ++i) {
    for (std::size_t c = 0; c < used; ++c) light[i] += double{picture.data[i * channels + c]};
    if (!std::isfinite(light[i])) light[i] = 0;
    light[i] = std::max(light[i], 0.0);
    if (light[i] > 0 && (counts.empty() || counts[i] != 0)) middle.push_back(light[i]);
  }
  const double half = middle.empty() ? 1 : stats::median(middle);
  io::GreyImage grey{picture.width, picture.height, {}, {}};
  for (const double v : light) {
    grey.values.push_back(static_cast<float>(255 * v / (v + half)));
    grey.bytes.push_back(static_cast<std::uint8_t>(std::lround(grey.values.back())));
  }
  return grey;
}

// Pixels near the circle, of those that count.
std::vector<unsigned char> looked_at(const io::Image& picture, const OutlineWish& wish) {
  std::vector<unsigned char> counts(wish.counts.begin(), wish.counts.end());
  if (!wish.near) return counts;
  constexpr double margin = 0.25;
  if (counts.empty()) counts.assign(picture.pixels(), 1);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const double off = norm(Vec2{double(x), double(y)} - wish.near->centre_px) / wish.near->radius_px - 1;
      if (std::abs(off) > margin)
        counts[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x)] = 0;
    }
  return counts;
}

bool leaves(const Outline& o, const io::Image& picture) {
  const double left = std::min(o.centre_px.x, o.centre_px.y) - o.radius_px;
  return left < 0 || o.centre_px.x + o.radius_px > picture.width - 1 ||
         o.centre_px.y + o.radius_px > picture.height - 1;
}

void check_circle(const io::Image& picture, const OutlineWish& wish, const std::string& place) {
  if (!wish.near) return;
  const auto& [centre, radius] = *wish.near;
  if (centre.x - radius < 0 || centre.y - radius < 0 || centre.x + radius > picture.width - 1 ||
      centre.y + radius > picture.height - 1)
    throw Error(Exit::data, place,
                format("the circle at %g, %g with a radius of %g px leaves the picture of %d x %d pixels", centre.x,
                       centre.y, radius, picture.width, picture.height),
                "the whole ball must be in the picture");
}

io::GreyImage linear(const io::Image& picture) {
  io::GreyImage grey = io::grey_of(picture);
  if (grey.values.empty()) grey.values.assign(grey.bytes.begin(), grey.bytes.end());
  return grey;
}

// Two values alone: somebody decided for each pixel. Others have grey levels where the outline runs through them.
bool is_drawn(const io::Image& silhouette) {
  const auto [least, most] = std::ranges::minmax(silhouette.data);
  return std::ranges::all_of(silhouette.data, [&](float v) { return v == least || v == most; });
}

// Without a start: circles that the detector of matt balls sees, each taken to the edges that a mirror has.
std::vector<Outline> found_alone(const io::Image& picture, const camera::CameraModel& camera, const OutlineWish& wish,
                                 const std::vector<unsigned char>& counts, std::string& why) {
  reassembly::DetectWish detect;
  detect.smallest_px = 10;
  detect.largest_px = std::max(0.6 * std::min(picture.width, picture.height), 2 * detect.smallest_px);
  detect.least_cover = 0.25;
  const io::GreyImage grey = wish.silhouette ? linear(*wish.silhouette) : compressed(picture, counts);
  reassembly::Detected detected = detect_spheres(grey, camera, detect, counts);
  std::ranges::stable_sort(detected.found, std::greater{}, [](const Outline& o) { return o.cover * o.radius_px; });
  double largest = 0;
  for (const reassembly::Refused& r : detected.refused)
    if (r.radius_px > largest)
      largest = r.radius_px, why = format("; what is at %.0f, %.0f ", r.centre_px.x, r.centre_px.y) + r.why;
  std::vector<Outline> found;
  const Doubt doubt = !wish.silhouette ? squeeze : is_drawn(*wish.silhouette) ? drawn : Doubt{};
  constexpr std::size_t most_tried = 4;  // beyond the balls that are asked for
  detected.found.resize(std::min(detected.found.size(), wish.balls + most_tried));
  for (const Outline& o : detected.found)
    if (auto outline = mirror_outline(grey, camera, {o.axis, o.half_angle_rad, 0.1}, counts))
      if (outline->cover >= least_cover_alone) {
        add_doubt(*outline, doubt);
        found.push_back(*outline);
      }
  return found;
}

}  // namespace

std::vector<Outline> ball_outlines(const io::Image& picture, const camera::CameraModel& camera, const OutlineWish& wish,
                                   const std::string& place) {
  check_circle(picture, wish, place);
  if (wish.near && wish.near->radius_px < 4)
    throw Error(Exit::data, place, format("a ball of %g px is too small", wish.near->radius_px),
                "its outline needs a radius of at least 4 px; hundreds show more");
  const std::vector<unsigned char> counts = looked_at(picture, wish);
  std::vector<Outline> found;
  std::string why;
  if (wish.near && !wish.silhouette) {
    const Vec3 axis = camera.ray(wish.near->centre_px).direction,
               rim = camera.ray(wish.near->centre_px + Vec2{wish.near->radius_px, 0}).direction;
    auto outline = mirror_outline(compressed(picture, counts), camera,
                                  {axis, std::atan2(norm(cross(axis, rim)), dot(axis, rim)), 0.1}, counts);
    if (outline) add_doubt(*outline, squeeze);
    if (outline && outline->cover >= least_cover) found.push_back(*outline);
    if (outline && outline->cover < least_cover)
      why = format("; near the circle edges show %.2f of one (limit %g)", outline->cover, least_cover);
  } else {
    found = found_alone(picture, camera, wish, counts, why);
  }
  if (found.size() < wish.balls)
    throw Error(Exit::data, place, format("shows %zu of %zu outlines of balls", found.size(), wish.balls) + why,
                "draw it: --circle X,Y,RADIUS, or --silhouette FILE");
  found.resize(wish.balls);
  std::ranges::sort(found, {}, [](const Outline& o) { return o.centre_px.x; });
  for (const Outline& o : found)
    if (leaves(o, picture))
      throw Error(Exit::data, place,
                  format("the ball at %.1f, %.1f with a radius of %.1f px is cut by the border", o.centre_px.x,
                         o.centre_px.y, o.radius_px),
                  "the whole ball must be in the picture");
  return found;
}

camera::CameraModel far_camera(int width_px, int height_px) {
  constexpr double sizes = 3000;
  camera::Intrinsics lens;
  lens.fx_px = lens.fy_px = sizes * std::max(width_px, height_px);
  lens.cx_px = (width_px - 1) / 2.0, lens.cy_px = (height_px - 1) / 2.0;
  return {lens, width_px, height_px};
}

std::vector<FoundBall> located_balls(const std::vector<OutlineView>& views, double radius_m, std::size_t balls,
                                     const std::string& place) {
  struct Group {
    std::vector<BallSighting> sightings;
    std::vector<reassembly::SeenBall> seen;
    Vec3 roughly_m;
  };
  std::vector<reassembly::View> posed(views.size());
  std::vector<Group> groups;
  for (std::size_t v = 0; v < views.size(); ++v) {
    posed[v].world_from_camera = views[v].world_from_camera;
    for (std::size_t k = 0; k < views[v].pose_sigma.size() && k < 6; ++k)
      posed[v].covariance[7 * k] = views[v].pose_sigma[k] * views[v].pose_sigma[k];
    for (const Outline& o : views[v].outlines) {
      const Vec3 at = posed[v].world_from_camera * (o.axis * reassembly::distance_m(o, radius_m));
      // A ball of the same size stands at least two radii away.
      auto group = std::ranges::find_if(groups, [&](const Group& g) {
        return norm(g.roughly_m - at) < 2 * radius_m && g.sightings.back().view != v;
      });
      if (group == groups.end()) group = groups.insert(groups.end(), Group{{}, {}, at});
      group->sightings.push_back({v, o});
      group->seen.push_back({&posed[v], o});
    }
  }
  if (groups.size() > balls)
    throw Error(Exit::data, place,
                format("the outlines belong to %zu places more than two radii apart, and the balls are %zu",
                       groups.size(), balls),
                "check the radius (--radius), the cameras' poses, and --balls");
  std::vector<FoundBall> found;
  for (const Group& g : groups) {
    const auto where = reassembly::place_of_ball(g.seen, radius_m, place);
    if (!where)
      throw Error(Exit::data, place, "the views' outlines do not meet in one ball",
                  "check the radius (--radius) and the cameras' poses");
    found.push_back(
        {{where->centre_m, radius_m}, where->covariance_m2, where->chi_square, where->degrees, g.sightings});
  }
  return found;
}

}  // namespace gonio::probe
