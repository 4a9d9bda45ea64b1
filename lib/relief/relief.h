// A relief: heights over a plane, on a regular grid, and what a ray meets on it.
//
// Local frame, metres: +x along a row, +y up the picture (against the order of a map's rows), +z out of the material.
// Point (i, j) lies at (i step_x, j step_y). Each cell between four points is a bilinear patch,
//   z(u, v) = z00 + (z10 - z00) u + (z01 - z00) v + (z00 - z10 - z01 + z11) u v,   u, v in [0, 1],
// continuous with its neighbours; its normal is that of the patch itself, so that what light meets is one consistent
// geometry. A periodic relief joins its last point to its first: the period is (nx step_x, ny step_y). An open one
// has one cell less on either side, and rays leave it sideways.
//
// A ray is followed from tile to tile of a pyramid that holds the lowest and highest height of 2^k x 2^k cells (after
// Tevs, Ihrke & Seidel 2008, "Maximum mipmaps for fast, accurate, and scalable dynamic height field rendering"): tiles
// that it passes above are skipped whole, and in a cell the patch's quadratic is solved. Cells are counted in integers,
// so that no ray slips between two.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "io/height_map.h"

namespace gonio::relief {

struct Place {  // on the relief: a cell, and where in it
  int i = 0, j = 0;
  double u = 0, v = 0;
};
struct Hit {
  Place place;
  Vec3 normal;  // unit, z > 0
  double z_m = 0;
};

class Relief {
 public:
  // `z_m`: ny rows of nx heights, +y upwards, finite; nx, ny >= 2. Error(data) at `place`.
  Relief(int nx, int ny, double step_x_m, double step_y_m, std::vector<double> z_m, bool periodic,
         const std::string& place = "relief");

  int nx() const { return nx_; }
  int ny() const { return ny_; }
  double step_x_m() const { return step_x_m_; }
  double step_y_m() const { return step_y_m_; }
  bool periodic() const { return periodic_; }
  int cells_x() const { return periodic_ ? nx_ : nx_ - 1; }
  int cells_y() const { return periodic_ ? ny_ : ny_ - 1; }
  double width_m() const { return cells_x() * step_x_m_; }
  double length_m() const { return cells_y() * step_y_m_; }
  double z_m(int i, int j) const { return z_m_[index(i, j)]; }
  double lowest_m() const { return levels_.back().low.front(); }
  double highest_m() const { return levels_.back().high.front(); }

  Vec3 normal(const Place& at) const;
  double height_m(const Place& at) const;

  // The first patch that a ray meets from above, which enters from beyond the highest point over (x, y), going down
  // (direction.z < 0), or which starts on the relief at `from` into a direction above its patch. None: it left.
  std::optional<Hit> met_from_above(double x_m, double y_m, Vec3 direction) const;
  std::optional<Hit> met_from(const Hit& from, Vec3 direction) const;
  bool escapes(const Hit& from, Vec3 direction) const { return !met_from(from, direction); }

 private:
  struct Level {  // tiles of 2^k x 2^k cells
    int nx = 0, ny = 0;
    std::vector<double> low, high;
  };
  struct Ray;
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i);
  }
  struct Patch {  // z = a + b u + c v + d u v
    double a, b, c, d;
  };
  Patch patch(int i, int j) const;
  void build_levels();
  std::optional<Hit> follow(Ray ray) const;
  std::optional<Hit> met_in_cell(Ray& ray, double leaves) const;
  bool step(Ray& ray, int level, double leaves, bool along_x) const;

  int nx_, ny_;
  double step_x_m_, step_y_m_;
  std::vector<double> z_m_;
  bool periodic_;
  std::vector<Level> levels_;
};

// How a measured patch, whose edges do not match, goes on: by its mirror images (continuous; 2 (n - 1) points a side),
// by itself (its edges become steps), or not at all.
enum class Tiling { mirrored, repeated, open };
// Heights of points that are missing are taken from a membrane over the gaps (Laplace's equation); `missing` says how
// many they were. Error(data) at `place` where more than half are missing.
Relief relief_of(const io::HeightMap& map, Tiling tiling, const std::string& place, std::size_t* missing = nullptr);
io::HeightMap map_of(const Relief& relief);  // rows from the top

}  // namespace gonio::relief
