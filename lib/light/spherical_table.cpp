#include "light/spherical_table.h"

#include <algorithm>
#include <cmath>

#include "light/distribution.h"

namespace gonio::light {
namespace {

struct Position {
  std::size_t cell;
  double share;  // within the cell, 0 .. 1
};

bool locate(const std::vector<double>& grid, double at, Position& position) {
  if (!(at >= grid.front() && at <= grid.back())) return false;
  const auto above = std::upper_bound(grid.begin(), grid.end(), at);
  const auto cell = std::min<std::ptrdiff_t>(above - grid.begin() - 1, static_cast<std::ptrdiff_t>(grid.size()) - 2);
  position.cell = static_cast<std::size_t>(cell);
  position.share = (at - grid[position.cell]) / (grid[position.cell + 1] - grid[position.cell]);
  return true;
}

class TabulatedLobe final : public Lobe {
 public:
  explicit TabulatedLobe(SphericalGrid grid) : grid_(whole(std::move(grid))), cells_(weights(), latitudes() - 1) {}

  double relative(Vec3 local) const override {
    Position latitude{}, longitude{};
    const double height = std::clamp(dot(local, grid_.pole), -1.0, 1.0);
    if (!locate(grid_.colatitude_rad, std::acos(height), latitude) ||
        !locate(grid_.longitude_rad, turn(local), longitude))
      return 0;
    const auto along = [&](std::size_t j) {
      return value(j, latitude.cell) * (1 - latitude.share) + value(j, latitude.cell + 1) * latitude.share;
    };
    return along(longitude.cell) * (1 - longitude.share) + along(longitude.cell + 1) * longitude.share;
  }

  Draw draw(Vec2 u) const override {
    const Distribution2::Cell cell = cells_.draw(u);
    const std::size_t i = cell.column, j = cell.row;
    const double share = cells_.share(j, i);
    if (!(share > 0)) return {};
    const double top = std::cos(grid_.colatitude_rad[i]), bottom = std::cos(grid_.colatitude_rad[i + 1]);
    const double height = top + (bottom - top) * cell.inside.x, r = std::sqrt(std::max(0.0, 1 - height * height));
    const double from = grid_.longitude_rad[j], to = grid_.longitude_rad[j + 1];
    const double phi = from + (to - from) * cell.inside.y;
    return {grid_.pole * height + (grid_.zero * std::cos(phi) + grid_.quarter * std::sin(phi)) * r,
            share / solid_angle(j, i)};
  }

 private:
  // A symmetric table as one of two longitudes.
  static SphericalGrid whole(SphericalGrid grid) {
    if (grid.longitude_rad.size() > 1) return grid;
    grid.longitude_rad = {0, 2 * pi};
    const std::vector<double> once = grid.value;
    grid.value.insert(grid.value.end(), once.begin(), once.end());
    return grid;
  }
  std::size_t latitudes() const { return grid_.colatitude_rad.size(); }
  double value(std::size_t j, std::size_t i) const { return grid_.value[j * latitudes() + i]; }
  double solid_angle(std::size_t j, std::size_t i) const {
    return (std::cos(grid_.colatitude_rad[i]) - std::cos(grid_.colatitude_rad[i + 1])) *
           (grid_.longitude_rad[j + 1] - grid_.longitude_rad[j]);
  }
  // Longitude in the turn that begins with the table's first.
  double turn(Vec3 local) const {
    const double phi = std::atan2(dot(local, grid_.quarter), dot(local, grid_.zero)), first = grid_.longitude_rad[0];
    return first + (phi - first) - 2 * pi * std::floor((phi - first) / (2 * pi));
  }
  std::vector<double> weights() const {
    std::vector<double> all;
    for (std::size_t j = 0; j + 1 < grid_.longitude_rad.size(); ++j)
      for (std::size_t i = 0; i + 1 < latitudes(); ++i)
        all.push_back((value(j, i) + value(j, i + 1) + value(j + 1, i) + value(j + 1, i + 1)) * solid_angle(j, i));
    return all;
  }

  SphericalGrid grid_;
  Distribution2 cells_;
};

}  // namespace

std::unique_ptr<const Lobe> tabulated_lobe(SphericalGrid grid) {
  return std::make_unique<TabulatedLobe>(std::move(grid));
}

}  // namespace gonio::light
