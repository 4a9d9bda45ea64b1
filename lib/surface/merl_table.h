// A measured isotropic table as a BRDF: interpolation, sampling and reflectance. Directions as in surface/surface.h.
//
// Cells of the file stand for the middles of their bins, theta_h = (i + 1/2)^2 / n^2 pi / 2, theta_d and phi_d uniform.
// Between them the BRDF is interpolated linearly in sqrt(theta_h), theta_d and phi_d; phi_d and phi_d + pi are the same
// cell, so that it is reciprocal. Cells that were not measured take the value of the next one with smaller theta_d,
// else of the next with larger; they lie at the horizon.
//
// Sampling: for 48 zeniths of wo, half vectors have a density that is constant over cells of (theta_h, azimuth from wo)
// and follows the luminance times cos(theta_i); wi is wo mirrored in h:
//   pdf = 0.9 p(h | zenith) / (4 wo.h) + 0.1 cos(theta_i) / pi
// The sums over the same cells are the directional-hemispherical reflectance. Measured tables can reflect more than
// they receive at grazing angles: up to `most_reflectance` that is let pass with a warning.
#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "geom/vector.h"
#include "io/merl.h"
#include "surface/surface.h"

namespace gonio::surface {

class MeasuredTable final : public Prepared {
 public:
  static constexpr double most_reflectance = 2;

  // `place` names it in warnings and in Error(data).
  MeasuredTable(io::MerlTable table, const std::string& place);

  Rgb evaluate(Vec3 wo, Vec3 wi) const;
  struct Drawn {
    Vec3 wi;
    double pdf = 0;  // 0 below the horizon
  };
  Drawn sample(Vec3 wo, Vec2 u, double u_lobe) const;
  double pdf(Vec3 wo, Vec3 wi) const;
  Rgb albedo(Vec3 wo) const;
  Rgb albedo_mean() const { return mean_; }  // bihemispherical

 private:
  static constexpr std::size_t zeniths = 48, columns = 32;
  void fill_unmeasured();
  void build(std::size_t zenith);
  void check(const std::string& place) const;
  static std::size_t zenith_of(Vec3 wo);
  float* row_of(std::size_t zenith) { return rows_.data() + zenith * (rings_ + 1); }
  const float* row_of(std::size_t zenith) const { return rows_.data() + zenith * (rings_ + 1); }
  float* cells_of(std::size_t zenith, std::size_t ring) {
    return cells_.data() + (zenith * rings_ + ring) * (columns + 1);
  }
  const float* cells_of(std::size_t zenith, std::size_t ring) const {
    return cells_.data() + (zenith * rings_ + ring) * (columns + 1);
  }
  double density_in(std::size_t zenith, std::size_t ring, std::size_t column) const;
  double half_vector_density(Vec3 wo, Vec3 h) const;

  io::MerlTable table_;
  std::size_t rings_;
  std::vector<double> ring_cosine_;  // of the rings' edges
  std::vector<float> rows_, cells_;  // cumulative over rings; over the columns of a ring
  std::vector<Rgb> albedo_;
  Rgb mean_;
};

// The table of a file, read once and shared while anybody holds it; read anew when the file has changed.
std::shared_ptr<const MeasuredTable> measured_table(const std::filesystem::path& file);

}  // namespace gonio::surface
