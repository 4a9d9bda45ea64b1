// See mix_ups.h.
#include "reassembly/mix_ups.h"

#include <algorithm>
#include <functional>
#include <set>

#include "base/text.h"

namespace gonio::reassembly {
namespace {

using Views = std::vector<View>;

struct Mistake {
  std::string sentence;  // what is wrong with the input, and what to do
  std::function<void(Views&)> undone;
};

std::size_t standing(const Placement& placement) {
  return static_cast<std::size_t>(std::ranges::count(placement.pieces, Verdict::placed, &Placed::verdict));
}

void turn_axes(Views& views, Quaternion by) {  // camera axes: world_from_camera * by
  for (View& view : views) view.world_from_camera.rotation = normalized(view.world_from_camera.rotation * by);
}

void mirror_pictures(Views& views, double x, double y) {
  for (View& view : views)
    for (Outline& outline : view.outlines) {
      outline.axis = {x * outline.axis.x, y * outline.axis.y, outline.axis.z};
      // In the basis of the mirrored axis, what leant one way leans the other.
      if (x * y < 0)
        for (const auto& [i, j] : {std::pair{0, 1}, {1, 0}, {0, 2}, {2, 0}}) outline.covariance_rad2(i, j) *= -1;
    }
}

std::vector<Mistake> of_all_cameras() {
  return {
      {"the poses of the images are camera_from_world: world_from_camera is asked for; invert them",
       [](Views& views) {
         for (View& view : views) {
           const auto turned = inverse(view.world_from_camera);
           view.world_from_camera = {turned.rotation, turned.translation_m};
         }
       }},
      {"the rotations of the images' poses are inverted (camera_from_world), their translations are not; invert them",
       [](Views& views) {
         for (View& view : views) view.world_from_camera.rotation = conjugate(view.world_from_camera.rotation);
       }},
      {"the images' poses are of camera axes with y up and z backward (OpenGL, Blender): here y points down and z "
       "forward; turn them by 180 degrees about x",
       [](Views& views) {
         turn_axes(views, {0, 1, 0, 0});
       }},
      {"the images' poses are of camera axes that are turned by 180 degrees about z, or the photographs are upside "
       "down; turn one of them",
       [](Views& views) {
         turn_axes(views, {0, 0, 0, 1});
       }},
      {"the photographs are mirrored, left for right; undo what flipped them",
       [](Views& views) { mirror_pictures(views, -1, 1); }},
      {"the photographs are mirrored, top for bottom; undo what flipped them",
       [](Views& views) { mirror_pictures(views, 1, -1); }},
      {"the places of the images' poses are in millimetres; divide them by 1000", [](Views& views) {
         for (View& view : views) view.world_from_camera.translation_m = 1e-3 * view.world_from_camera.translation_m;
       }}};
}

// The k-th photograph of the one camera was taken with the k-th of the other.
void exchange(Views& views, std::span<const std::string> cameras, const std::string& a, const std::string& b) {
  std::vector<std::size_t> of_a, of_b;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (cameras[v] == a) of_a.push_back(v);
    if (cameras[v] == b) of_b.push_back(v);
  }
  for (std::size_t k = 0; k < std::min(of_a.size(), of_b.size()); ++k)
    std::swap(views[of_a[k]].outlines, views[of_b[k]].outlines);
}

std::vector<Mistake> mistakes(std::span<const std::string> cameras) {
  std::vector<Mistake> all = of_all_cameras();
  const std::set<std::string> names(cameras.begin(), cameras.end());
  for (auto a = names.begin(); a != names.end(); ++a)
    for (auto b = std::next(a); b != names.end(); ++b)
      all.push_back(
          {"the photographs of cameras " + *a + " and " + *b + " are exchanged, left for right; exchange them",
           [one = *a, other = *b, cameras](Views& views) { exchange(views, cameras, one, other); }});
  return all;
}

}  // namespace

std::string mix_up(std::span<const View> views, std::span<const std::string> cameras, std::span<const Piece> pieces,
                   const PlaceWish& wish, const Placement& placement) {
  std::size_t best = standing(placement);
  std::string sentence;
  for (const Mistake& mistake : mistakes(cameras)) {
    Views undone(views.begin(), views.end());
    mistake.undone(undone);
    const std::size_t now = standing(place(undone, bundles(undone, wish), pieces, wish));
    if (now > best) best = now, sentence = mistake.sentence;
  }
  return sentence;
}

}  // namespace gonio::reassembly
