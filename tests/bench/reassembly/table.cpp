// Backdrop, stand and cloth: table.h.
#include "table.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "glassware.h"

namespace gonio::reassembly_experiment {
namespace {

constexpr int checks_across = 30, checks_up = 20, cells_a_check = 4;
constexpr double check_m = 0.04;
constexpr double cell_m = 0.0025;  // of the cloth
constexpr int columns = 240, rows = 216;
constexpr double cloth_left_m = -0.28, cloth_front_m = -0.32;
constexpr double around_m = 0.03;  // beyond a foot, over which the cloth rises to its old height

// A grid of (nx + 1) x (ny + 1) vertices, appended; u x v points to the side that is seen.
void add_grid(io::TriangleMesh& mesh, int nx, int ny, Vec3 corner, Vec3 u, Vec3 v) {
  const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
  const auto wide = static_cast<std::uint32_t>(nx + 1);
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) mesh.positions_m.push_back(corner + u * i + v * j);
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(ny); ++j)
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(nx); ++i) {
      const std::uint32_t at = first + j * wide + i;
      mesh.triangles.push_back({at, at + 1, at + wide + 1});
      mesh.triangles.push_back({at, at + wide + 1, at + wide});
    }
}

double smooth_step(double t) {
  const double s = std::clamp(t, 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

// The cloth before anything stood on it: ripples everywhere, folds clear of the two vessels.
double rest_height(double x, double y, const Table& table) {
  struct Fold {
    double angle, offset, height, width;
  };
  constexpr Fold folds[] = {{1.25, -0.155, 0.008, 0.009}, {1.5, 0.012, 0.006, 0.007},  {1.85, 0.215, 0.009, 0.010},
                            {0.15, -0.115, 0.007, 0.010}, {-0.2, 0.105, 0.006, 0.008}, {0.05, -0.215, 0.009, 0.012}};
  double clear = 1;
  for (const Standing* at : {&table.bowl, &table.pot})
    clear *= smooth_step((std::hypot(x - at->x_m, y - at->y_m) - 0.045) / 0.035);
  double z = 0.0005 * std::sin(68 * x + 1) * std::cos(55 * y) + 0.0003 * std::sin(121 * x - 87 * y);
  for (const Fold& fold : folds) {
    const double s = (std::sin(fold.angle) * x + std::cos(fold.angle) * y - fold.offset) / fold.width;
    z += clear * fold.height * std::exp(-s * s);
  }
  return z;
}

// How far every vertex of the cloth gives way under a foot: at least to below the ring, and from there as a membrane
// does (Laplace's equation, by over-relaxation) to nothing at around_m.
void press(std::vector<double>& heights, const Standing& at, double& deepest) {
  const int n = columns + 1;
  std::vector<double> down(heights.size(), 0);
  std::vector<char> free(heights.size(), 0);
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const auto k = static_cast<std::size_t>(j * n + i);
      const double r = std::hypot(cloth_left_m + i * cell_m - at.x_m, cloth_front_m + j * cell_m - at.y_m);
      if (r > foot_inner_m - 1.5 * cell_m && r < foot_outer_m + 1.5 * cell_m) {
        down[k] = std::max(0.0, heights[k] - at.z_m + 5e-5);
        deepest = std::max(deepest, down[k]);
      } else {
        free[k] = r < foot_outer_m + around_m;
      }
    }
  for (int round = 0; round < 300; ++round)
    for (int j = 1; j < rows; ++j)
      for (int i = 1; i < columns; ++i) {
        const auto k = static_cast<std::size_t>(j * n + i);
        if (!free[k]) continue;
        const double around = 0.25 * (down[k - 1] + down[k + 1] + down[k - static_cast<std::size_t>(n)] +
                                      down[k + static_cast<std::size_t>(n)]);
        down[k] += 1.8 * (around - down[k]);
      }
  for (std::size_t k = 0; k < heights.size(); ++k) heights[k] -= std::max(0.0, down[k]);
}

double highest_under(const std::vector<double>& heights, const Standing& at) {
  double highest = -1;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const double r = std::hypot(cloth_left_m + i * cell_m - at.x_m, cloth_front_m + j * cell_m - at.y_m);
      if (r > foot_inner_m && r < foot_outer_m)
        highest = std::max(highest, heights[static_cast<std::size_t>(j * (columns + 1) + i)]);
    }
  return highest;
}

io::TriangleMesh with_heights(const std::vector<double>& heights) {
  io::TriangleMesh mesh;
  add_grid(mesh, columns, rows, {cloth_left_m, cloth_front_m, 0}, {cell_m, 0, 0}, {0, cell_m, 0});
  for (std::size_t k = 0; k < heights.size(); ++k) mesh.positions_m[k].z = heights[k];
  for (const auto& t : mesh.triangles) {
    const Vec3 p = (mesh.positions_m[t[0]] + mesh.positions_m[t[1]] + mesh.positions_m[t[2]]) / 3;
    const bool band =
        std::abs(p.x + 0.4 * p.y + 0.06) < 0.016 || std::abs(p.x - 0.12) < 0.012 || std::abs(p.y + 0.10) < 0.014;
    mesh.labels.push_back(band ? blue_cloth : white_cloth);
  }
  const std::size_t cloth = mesh.triangles.size();
  add_grid(mesh, checks_across * cells_a_check, checks_up * cells_a_check, {-0.6, 0.28, -0.1},
           {check_m / cells_a_check, 0, 0}, {0, 0, check_m / cells_a_check});
  for (std::size_t t = 0; t < mesh.triangles.size() - cloth; ++t) {
    const auto cell = static_cast<int>(t / 2), wide = checks_across * cells_a_check;
    mesh.labels.push_back((cell % wide / cells_a_check + cell / wide / cells_a_check) % 2 == 0 ? white_card
                                                                                               : grey_card);
  }
  add_grid(mesh, 4, 4, {-0.32, -0.36, -0.008}, {0.17, 0, 0}, {0, 0.15, 0});
  add_grid(mesh, 4, 1, {-0.32, -0.36, -0.04}, {0.17, 0, 0}, {0, 0, 0.032});  // its front
  mesh.labels.resize(mesh.triangles.size(), stand);
  return mesh;
}

}  // namespace

Table table(double pressed_m) {
  Table result;
  result.bowl = {-0.080, -0.015, 0.35, 0}, result.pot = {0.092, 0.025, -0.45, 0};
  std::vector<double> heights;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i)
      heights.push_back(rest_height(cloth_left_m + i * cell_m, cloth_front_m + j * cell_m, result));
  result.rest = with_heights(heights);
  for (Standing* at : {&result.bowl, &result.pot}) {
    at->z_m = highest_under(heights, *at) - pressed_m;
    press(heights, *at, result.deepest_m);
  }
  result.pressed = with_heights(heights);
  return result;
}

io::TriangleMesh scanned(const io::TriangleMesh& mesh, double sigma_m, std::uint64_t seed) {
  // White noise, three times averaged over a vertex and its neighbours, brought back to sigma_m.
  const std::size_t n = mesh.positions_m.size();
  std::vector<double> error(n);
  Random random(seed);
  for (double& e : error) e = random.normal();
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<double> sum = error, count(n, 1);
    for (const auto& t : mesh.triangles)
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::size_t a = t[corner], b = t[(corner + 1) % 3];
        sum[a] += error[b], count[a] += 1;
        sum[b] += error[a], count[b] += 1;
      }
    for (std::size_t k = 0; k < n; ++k) error[k] = sum[k] / count[k];
  }
  double square = 0;
  for (const double e : error) square += e * e;
  const double scale = sigma_m / std::sqrt(square / static_cast<double>(n));
  io::TriangleMesh result = mesh;
  const std::size_t cloth = static_cast<std::size_t>((columns + 1) * (rows + 1));
  for (std::size_t k = 0; k < n; ++k)
    (k < cloth ? result.positions_m[k].z : result.positions_m[k].y) += scale * error[k];
  return result;
}

}  // namespace gonio::reassembly_experiment
