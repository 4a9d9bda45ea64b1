#include "surface/merl_table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "base/error.h"
#include "base/progress.h"
#include "surface/half_angle.h"
#include "surface/hemisphere.h"
#include "surface/microfacet.h"

namespace gonio::surface {
namespace {

constexpr double lobe_share = 0.9;

// A place between two neighbouring cells.
struct Between {
  std::size_t low, high;
  float share;  // of `high`
};

Between clamped(double x, std::size_t count) {
  const double c = std::clamp(x - 0.5, 0.0, static_cast<double>(count - 1));
  const auto low = std::min(static_cast<std::size_t>(c), count - 2);
  return {low, low + 1, static_cast<float>(c - static_cast<double>(low))};
}

Between wrapped(double x, std::size_t count) {
  const double c = x < 0.5 ? x - 0.5 + static_cast<double>(count) : x - 0.5;
  const auto low = std::min(static_cast<std::size_t>(c), count - 1);
  return {low, low + 1 == count ? 0 : low + 1, static_cast<float>(c - static_cast<double>(low))};
}

double across_of(Vec3 w) {
  return std::sqrt(w.x * w.x + w.y * w.y);
}

// The horizontal direction of w, +x where it has none.
Vec2 bearing(Vec3 w) {
  const double across = across_of(w);
  return across > 0 ? Vec2{w.x / across, w.y / across} : Vec2{1, 0};
}

// Azimuth of h from that of wo.
double azimuth_from(Vec3 wo, Vec3 h) {
  const Vec2 along = bearing(wo);
  const double x = along.x * h.x + along.y * h.y, y = along.x * h.y - along.y * h.x;
  return y < 0 ? -arc(-y, x) : arc(y, x);
}

// Where `u` falls into cumulative shares of `count` cells; the remainder is stretched over the cell.
std::size_t draw(const float* cumulative, std::size_t count, double& u) {
  const auto* above = std::upper_bound(cumulative + 1, cumulative + count, static_cast<float>(u));
  const auto cell = static_cast<std::size_t>(above - cumulative) - 1;
  const double low = cumulative[cell], width = cumulative[cell + 1] - low;
  u = width > 0 ? std::clamp((u - low) / width, 0.0, 1.0) : 0.5;
  return cell;
}

// Cumulative shares of masses 1..count, in place; uniform where all vanish. The sum.
double accumulate(float* masses, std::size_t count) {
  double total = 0;
  for (std::size_t i = 1; i <= count; ++i) total += masses[i];
  double sum = 0;
  masses[0] = 0;
  for (std::size_t i = 1; i <= count; ++i) {
    sum += total > 0 ? masses[i] / total : 1.0 / static_cast<double>(count);
    masses[i] = static_cast<float>(std::min(sum, 1.0));
  }
  masses[count] = 1;
  return total;
}

}  // namespace

MeasuredTable::MeasuredTable(io::MerlTable table, const std::string& place)
    : table_(std::move(table)), rings_(std::min<std::size_t>(table_.bins[0], 90)), albedo_(zeniths) {
  fill_unmeasured();
  for (std::size_t i = 0; i <= rings_; ++i) {
    const double u = static_cast<double>(i) / static_cast<double>(rings_);
    ring_cosine_.push_back(i == rings_ ? 0 : std::cos(u * u * pi / 2));
  }
  rows_.resize(zeniths * (rings_ + 1));
  cells_.resize(zeniths * rings_ * (columns + 1));
  for (std::size_t zenith = 0; zenith < zeniths; ++zenith) build(zenith);
  for (std::size_t i = 0; i < zeniths; ++i) {
    const double low = static_cast<double>(i) * pi / 2 / zeniths, high = low + pi / 2 / zeniths;
    mean_ += albedo_[i] * (std::sin(high) * std::sin(high) - std::sin(low) * std::sin(low));
  }
  check(place);
}

void MeasuredTable::fill_unmeasured() {
  const auto [rings, tilts, turns] = table_.bins;
  const auto cell = [&](std::size_t h, std::size_t d, std::size_t p) {
    return table_.brdf_per_sr.data() + 3 * ((h * tilts + d) * turns + p);
  };
  const auto measured = [](const float* v) { return v[0] >= 0 && v[1] >= 0 && v[2] >= 0; };
  for (std::size_t h = 0; h < rings; ++h)
    for (std::size_t p = 0; p < turns; ++p) {
      std::size_t first = 0;
      while (first < tilts && !measured(cell(h, first, p))) ++first;
      for (std::size_t d = 0; d < tilts; ++d) {
        if (d > first && measured(cell(h, d, p))) continue;
        for (std::size_t band = 0; band < 3; ++band)
          if (first == tilts)
            cell(h, d, p)[band] = 0;
          else if (d != first)
            cell(h, d, p)[band] = cell(h, d > first ? d - 1 : first, p)[band];
      }
    }
}

Rgb MeasuredTable::evaluate(Vec3 wo, Vec3 wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  const HalfAngles at = half_angles(wo, wi);
  const auto [rings, tilts, turns] = table_.bins;
  const Between h = clamped(static_cast<double>(rings) * std::sqrt(at.theta_h * (2 / pi)), rings);
  const Between d = clamped(static_cast<double>(tilts) * at.theta_d * (2 / pi), tilts);
  const Between p = wrapped(static_cast<double>(turns) * at.phi_d / pi, turns);
  const float* data = table_.brdf_per_sr.data();
  float red = 0, green = 0, blue = 0;
  const auto add = [&](std::size_t i, std::size_t j, float weight) {
    const float* row = data + 3 * ((i * tilts + j) * turns);
    const float* low = row + 3 * p.low;
    const float* high = row + 3 * p.high;
    const float wl = weight * (1 - p.share), wh = weight * p.share;
    red += wl * low[0] + wh * high[0];
    green += wl * low[1] + wh * high[1];
    blue += wl * low[2] + wh * high[2];
  };
  add(h.low, d.low, (1 - h.share) * (1 - d.share));
  add(h.low, d.high, (1 - h.share) * d.share);
  add(h.high, d.low, h.share * (1 - d.share));
  add(h.high, d.high, h.share * d.share);
  return {red, green, blue};
}

std::size_t MeasuredTable::zenith_of(Vec3 wo) {
  const double angle = arc(across_of(wo), wo.z);
  return std::min(static_cast<std::size_t>(angle * (2 / pi) * zeniths), zeniths - 1);
}

// Masses of the cells by a midpoint rule of three by two points, and the reflectance on the way:
//   integral of f cos(theta_i) dwi = integral of f cos(theta_i) 4 (wo.h) dh
void MeasuredTable::build(std::size_t zenith) {
  constexpr int radial = 3, angular = 2;
  const double theta = (static_cast<double>(zenith) + 0.5) * pi / 2 / zeniths;
  const Vec3 wo{std::sin(theta), 0, std::cos(theta)};
  for (std::size_t ring = 0; ring < rings_; ++ring) {
    float* masses = cells_of(zenith, ring);
    for (std::size_t column = 0; column < columns; ++column) {
      Rgb sum;
      for (int a = 0; a < radial; ++a)
        for (int b = 0; b < angular; ++b) {
          const double z = ring_cosine_[ring] + (ring_cosine_[ring + 1] - ring_cosine_[ring]) * (a + 0.5) / radial;
          const double phi = ((static_cast<double>(column) + (b + 0.5) / angular) / columns - 0.5) * 2 * pi;
          const double across = std::sqrt(std::max(0.0, 1 - z * z));
          const Vec3 h{across * std::cos(phi), across * std::sin(phi), z}, wi = mirrored(wo, h);
          const double cosine = dot(wo, h);
          if (cosine > 0 && wi.z > 0) sum += evaluate(wo, wi) * (wi.z * 4 * cosine);
        }
      const double area = (ring_cosine_[ring] - ring_cosine_[ring + 1]) * 2 * pi / columns;
      sum *= area / (radial * angular);
      albedo_[zenith] += sum;
      masses[column + 1] = static_cast<float>(mean(sum));
    }
    row_of(zenith)[ring + 1] = static_cast<float>(accumulate(masses, columns));
  }
  accumulate(row_of(zenith), rings_);
}

void MeasuredTable::check(const std::string& place) const {
  double most = 0;
  std::size_t worst = 0;
  for (std::size_t i = 0; i < zeniths; ++i)
    if (max_component(albedo_[i]) > most) {
      most = max_component(albedo_[i]);
      worst = i;
    }
  if (most <= 1) return;
  const std::string problem = "reflects " + std::to_string(most) + " of the light that arrives at " +
                              std::to_string((static_cast<double>(worst) + 0.5) * 90 / zeniths) + " degrees";
  if (most > most_reflectance)
    throw Error(Exit::data, place, problem + ", more than " + std::to_string(most_reflectance),
                "check that the table holds a BRDF in 1/sr over the MERL factors");
  log(LogLevel::warning, place + ": " + problem + ": pictures will be too bright there; `scale` makes it darker");
}

double MeasuredTable::density_in(std::size_t zenith, std::size_t ring, std::size_t column) const {
  const float *row = row_of(zenith), *cell = cells_of(zenith, ring);
  const double mass =
      static_cast<double>(row[ring + 1] - row[ring]) * static_cast<double>(cell[column + 1] - cell[column]);
  return mass / ((ring_cosine_[ring] - ring_cosine_[ring + 1]) * 2 * pi / columns);
}

double MeasuredTable::half_vector_density(Vec3 wo, Vec3 h) const {
  const auto guess = static_cast<double>(rings_) * std::sqrt(arc(across_of(h), h.z) * (2 / pi));
  const std::size_t ring = std::min(static_cast<std::size_t>(guess), rings_ - 1);
  const double turn = azimuth_from(wo, h) / (2 * pi) + 0.5;
  const std::size_t column = std::min(static_cast<std::size_t>(std::max(0.0, turn) * columns), columns - 1);
  return density_in(zenith_of(wo), ring, column);
}

double MeasuredTable::pdf(Vec3 wo, Vec3 wi) const {
  if (wo.z <= 0 || wi.z <= 0) return 0;
  const Vec3 h = half_vector(wo, wi);
  const double cosine = dot(wo, h);
  const double lobe = cosine > 0 ? half_vector_density(wo, h) / (4 * cosine) : 0;
  return lobe_share * lobe + (1 - lobe_share) * cosine_density(wi);
}

MeasuredTable::Drawn MeasuredTable::sample(Vec3 wo, Vec2 u, double u_lobe) const {
  if (u_lobe >= lobe_share) {
    const Vec3 wi = cosine_direction(u);
    return {wi, pdf(wo, wi)};
  }
  const std::size_t zenith = zenith_of(wo), ring = draw(row_of(zenith), rings_, u.x),
                    column = draw(cells_of(zenith, ring), columns, u.y);
  const double z = ring_cosine_[ring] + (ring_cosine_[ring + 1] - ring_cosine_[ring]) * u.x;
  const double phi = ((static_cast<double>(column) + u.y) / columns - 0.5) * 2 * pi;
  const double across = std::sqrt(std::max(0.0, 1 - z * z));
  const Vec2 along = bearing(wo);
  const double c = std::cos(phi), s = std::sin(phi);
  const Vec3 h{across * (along.x * c - along.y * s), across * (along.y * c + along.x * s), z}, wi = mirrored(wo, h);
  const double cosine = dot(wo, h);
  if (wi.z <= 0 || !(cosine > 0)) return {wi, 0};
  return {wi, lobe_share * density_in(zenith, ring, column) / (4 * cosine) + (1 - lobe_share) * cosine_density(wi)};
}

Rgb MeasuredTable::albedo(Vec3 wo) const {
  if (wo.z <= 0) return {};
  const double angle = arc(across_of(wo), wo.z);
  const Between at = clamped(angle * (2 / pi) * zeniths, zeniths);
  return albedo_[at.low] + (albedo_[at.high] - albedo_[at.low]) * static_cast<double>(at.share);
}

std::shared_ptr<const MeasuredTable> measured_table(const std::filesystem::path& file) {
  struct Known {
    std::filesystem::file_time_type time;
    std::weak_ptr<const MeasuredTable> table;
  };
  static std::mutex mutex;
  static std::map<std::string, Known> known;
  std::error_code missing;
  const auto time = std::filesystem::last_write_time(file, missing);
  const std::lock_guard lock(mutex);
  Known& entry = known[file.string()];
  auto table = entry.table.lock();
  if (table && !missing && entry.time == time) return table;
  table = std::make_shared<const MeasuredTable>(io::read_merl(file), file.string());
  entry = {time, table};
  return table;
}

}  // namespace gonio::surface
