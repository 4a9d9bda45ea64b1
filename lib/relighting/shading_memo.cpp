#include "relighting/shading_memo.h"

#include <algorithm>
#include <cstring>

namespace gonio::relighting {
namespace {

constexpr std::size_t kept = 3;  // of an image

void append(std::vector<double>& key, const Rgb& rgb) {
  key.insert(key.end(), {rgb.x, rgb.y, rgb.z});
}
// An address as a number of the same bits.
void append(std::vector<double>& key, const void* address) {
  double bits = 0;
  static_assert(sizeof bits >= sizeof address);
  std::memcpy(&bits, &address, sizeof address);
  key.push_back(bits);
}
}  // namespace

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

void append_key(std::vector<double>& key, const SurfaceState& surface, bool any_albedo) {
  append(key, static_cast<const void*>(surface.model));
  append(key, static_cast<const void*>(surface.values.prepared));
  append(key, static_cast<const void*>(surface.values.base));
  const std::size_t count = surface.model->info().parameters.size();
  const bool left_out =
      any_albedo && has_parameter(*surface.model, "albedo") && surface.model->proportional_to_albedo(surface.values);
  const std::size_t albedo = left_out ? parameter_index(*surface.model, "albedo") : count;
  for (std::size_t i = 0; i < count; ++i)
    if (i != albedo) append(key, surface.values.v[i]);
}

std::vector<double> shading_key(const SceneState& edited, std::span<const Use> uses) {
  std::vector<double> key;
  bool terms = false;
  for (const Use& use : uses) {
    if (use.term->shade == nullptr || use.neutral(edited)) continue;
    terms = true;
    key.push_back(static_cast<double>(use.place));
    key.insert(key.end(), edited.amounts[use.place].begin(), edited.amounts[use.place].end());
  }
  for (const SurfaceState& s : edited.surfaces) append_key(key, s, !terms);
  for (const LightState& l : edited.lights) {
    key.insert(key.end(),
               {l.radius_m, l.tilt_x_rad, l.tilt_y_rad, l.nearness_per_m, static_cast<double>(l.lobe.size())});
    append(key, l.shift_m);
    key.insert(key.end(), l.lobe.begin(), l.lobe.end());
    if (terms) append(key, l.intensity);
  }
  if (!terms) return key;
  append(key, edited.ambient);
  key.insert(key.end(), {edited.falloff, edited.indirect});
  for (const Rgb& gain : edited.gain) append(key, gain);
  return key;
}

std::shared_ptr<const Shaded> ShadingMemo::find(std::size_t image, const std::vector<double>& key,
                                                std::span<const std::uint32_t> picked) const {
  const std::lock_guard lock(mutex_);
  for (const Entry& e : of_image_[image])
    if (same_bits(e.key, key) && std::ranges::equal(e.picked, picked)) return e.shaded;
  return nullptr;
}

void ShadingMemo::keep(std::size_t image, std::vector<double> key, std::span<const std::uint32_t> picked,
                       std::shared_ptr<const Shaded> shaded) {
  const std::lock_guard lock(mutex_);
  std::vector<Entry>& entries = of_image_[image];
  entries.insert(entries.begin(), {std::move(key), {picked.begin(), picked.end()}, std::move(shaded)});
  if (entries.size() > kept) entries.pop_back();
}

}  // namespace gonio::relighting
