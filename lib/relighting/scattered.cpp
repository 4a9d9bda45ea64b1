#include "relighting/scattered.h"

#include <algorithm>
#include <cmath>

#include "relighting/shading_memo.h"

namespace gonio::relighting {
namespace {

constexpr std::size_t kept = 8;

bool is_zero(const SurfaceState& surface, const char* name) {
  return !has_parameter(*surface.model, name) || surface.values.scalar(parameter_index(*surface.model, name)) == 0;
}

}  // namespace

Extremes::Extremes(const SurfaceState& surface) : black(surface.values), white(surface.values) {
  has_base = has_parameter(*surface.model, "albedo");
  if (!has_base) return;
  const std::size_t albedo = parameter_index(*surface.model, "albedo");
  black.v[albedo] = {0, 0, 0};
  white.v[albedo] = {1, 1, 1};
  proportional = surface.model->proportional_to_albedo(surface.values);
  if (!proportional) {
    white = surface.values;
    colour = surface.values.rgb(albedo);
    return;
  }
  const auto& parameters = surface.model->info().parameters;
  at_once = std::count_if(parameters.begin(), parameters.end(),
                          [](const manifest::ParameterInfo& p) { return p.components == 3; }) == 1;
  if (at_once) white.v[albedo] = {0, 1, 1};
}

Scattered scattered_towards(const SurfaceState& surface, Vec3 wo) {
  const auto sent = [&](const surface::Values& v) { return surface.model->albedo(v, wo); };
  if (!has_parameter(*surface.model, "metal")) return Extremes(surface).split(sent);
  // A metal mirrors what comes from other surfaces; its matte part spreads it.
  const std::size_t metal = parameter_index(*surface.model, "metal"),
                    albedo = parameter_index(*surface.model, "albedo");
  const double share = surface.values.scalar(metal);
  SurfaceState matte = surface;
  matte.values.v[metal] = {0, 0, 0};
  Scattered all = Extremes(matte).split(sent);
  if (!(share > 0)) return all;
  all.base = all.base * (1 - share);
  all.gloss = sent(surface.values) - all.base * surface.values.rgb(albedo);
  return all;
}

ScatteredBy::ScatteredBy(const SurfaceState& surface) {
  for (std::size_t k = 0; k < nodes; ++k) {
    const double root = std::max(1e-3, static_cast<double>(k) / (nodes - 1)), z = root * root;
    table_.push_back(scattered_towards(surface, {std::sqrt(1 - z * z), 0, z}));
  }
}

Scattered ScatteredBy::operator()(Vec3 wo) const {
  const double x = std::sqrt(std::clamp(wo.z, 0.0, 1.0)) * (nodes - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(x), nodes - 2);
  const double t = x - static_cast<double>(k);
  return {table_[k].base * (1 - t) + table_[k + 1].base * t, table_[k].gloss * (1 - t) + table_[k + 1].gloss * t};
}

std::shared_ptr<const ScatteredBy> ScatteredMemo::of(const SurfaceState& surface, std::size_t facets) {
  if (facets < 2 * ScatteredBy::nodes || is_zero(surface, "metal") || !is_zero(surface, "anisotropy")) return nullptr;
  std::vector<double> key;
  append_key(key, surface);
  {
    const std::lock_guard lock(mutex_);
    const auto known = std::ranges::find_if(entries_, [&](const Entry& e) { return same_bits(e.key, key); });
    if (known != entries_.end()) return known->table;
  }
  auto table = std::make_shared<const ScatteredBy>(surface);
  const std::lock_guard lock(mutex_);
  entries_.insert(entries_.begin(), {std::move(key), table});
  if (entries_.size() > kept) entries_.pop_back();
  return table;
}

}  // namespace gonio::relighting
