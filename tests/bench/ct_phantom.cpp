// The other side of `scripts/experiments/ct-cleaning.mk`: a phantom, what a tomograph makes of it, and its true
// surface. usage: ct-phantom NAME VOXELS PHOTONS SEED FOLDER
//   NAME: glass-tube, hollow-sphere, bowl, teapot; writes FOLDER/volume.nrrd (uint16), FOLDER/true.ply (the glass
//   alone, in the volume's frame, metres) and FOLDER/markers.csv (true centres and
//   radii) and FOLDER/room.exr, surroundings of 30 x 15 checks that show how glass bends light.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>

#include "base/parallel.h"
#include "ct/scanner.h"
#include "io/picture.h"
#include "io/ply.h"
#include "volume/contour.h"

namespace {

using namespace gonio;

constexpr std::size_t finer = 2;  // samples of the distance per voxel

ct::Phantom phantom_of(const std::string& name, const ct::Place& place) {
  if (name == "glass-tube") return ct::glass_tube(place);
  if (name == "hollow-sphere") return ct::hollow_sphere(place);
  if (name == "bowl") return ct::bowl_with_lid(place);
  if (name == "teapot") return ct::teapot(place);
  throw std::invalid_argument("no phantom " + name);
}

// Signed distance to the glass: the first part's, or, where several parts are of it, their union's.
double distance_of(const ct::Phantom& phantom, Vec3 p) {
  double nearest = 1e9;
  for (std::size_t part = 0; part < phantom.parts.size(); ++part)
    if (phantom.parts[part].name != "markers") nearest = std::min(nearest, phantom.distance_m(p, part));
  return nearest;
}

Vec3 gradient_of(const ct::Phantom& phantom, Vec3 p, double h) {
  const auto at = [&](Vec3 d) { return distance_of(phantom, p + d) - distance_of(phantom, p - d); };
  return Vec3{at({h, 0, 0}), at({0, h, 0}), at({0, 0, h})} / (2 * h);
}

// The zero set of the distance: contoured on a grid finer than the scan's, then every vertex moved onto it.
io::TriangleMesh true_surface(const ct::Phantom& phantom, const ct::Scanner& scanner) {
  const std::size_t side = finer * scanner.voxels;
  const double step = scanner.voxel_m / static_cast<double>(finer);
  io::VolumeData field;
  field.head.size = {side, side, side}, field.head.type = io::VoxelType::f32;
  field.values.resize(side * side * side);
  const auto place = [&](double i, double j, double k) {
    const double middle = 0.5 * (static_cast<double>(side) - 1);
    return Vec3{(i - middle) * step, (j - middle) * step, (k - middle) * step};
  };
  parallel_for(0, side, [&](std::size_t k) {
    for (std::size_t j = 0; j < side; ++j)
      for (std::size_t i = 0; i < side; ++i)
        field.values[(k * side + j) * side + i] = static_cast<float>(
            -distance_of(phantom, place(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k))));
  });
  const volume::Contour contour = volume::contour(*io::source_of(std::move(field)), {});
  io::TriangleMesh mesh;
  mesh.triangles = contour.triangles;
  mesh.positions_m.resize(contour.positions.size());
  mesh.normals.resize(contour.positions.size());
  parallel_for(
      0, contour.positions.size(),
      [&](std::size_t v) {
        Vec3 p = place(contour.positions[v][0], contour.positions[v][1], contour.positions[v][2]);
        for (int n = 0; n < 4; ++n) {
          const Vec3 g = gradient_of(phantom, p, 0.01 * step);
          const double steep = dot(g, g), shift = distance_of(phantom, p);
          if (!(steep > 0.25) || std::abs(shift) > step) break;  // a crease: stays where the contour put it
          p += g * (-shift / steep);
        }
        const Vec3 n = gradient_of(phantom, p, 0.05 * step);
        mesh.positions_m[v] = p;
        mesh.normals[v] = norm(n) > 0 ? n / norm(n) : Vec3{0, 0, 1};
      },
      256);
  return mesh;
}

// Checks, bright below one another and tinted by their place, so that a shift is seen in every channel.
io::Image room() {
  io::Image image(960, 480, {"R", "G", "B"});
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const bool bright = (x / 32 + y / 32) % 2 == 0;
      const std::array<float, 3> tint{0.4f + 0.6f * static_cast<float>(x) / 960, 0.8f,
                                      0.4f + 0.6f * static_cast<float>(y) / 480};
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = tint[static_cast<std::size_t>(c)] * (bright ? 1.0f : 0.1f);
    }
  return image;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 6) {
    std::fprintf(stderr, "usage: ct-phantom NAME VOXELS PHOTONS SEED FOLDER\n");
    return 64;
  }
  const std::string folder = argv[5];
  ct::Scanner scanner;
  scanner.voxels = std::stoul(argv[2]), scanner.photons = std::stod(argv[3]), scanner.seed = std::stoul(argv[4]);
  const ct::Phantom phantom = phantom_of(argv[1], {scanner.voxels, scanner.voxel_m});
  const io::VolumeData scanned = ct::scan(phantom, scanner);
  float largest = 0;
  for (const float v : scanned.values) largest = std::max(largest, v);
  io::write_nrrd(folder + "/volume.nrrd", ct::stored_as(scanned, io::VoxelType::u16, 50000.0 / largest, 8000));
  // The volume's frame: its origin and axes as told; the phantom's frame where nothing is told wrongly.
  io::write_ply(folder + "/true.ply", true_surface(phantom, scanner));
  io::write_picture(folder + "/room.exr", room());
  std::ofstream markers(folder + "/markers.csv");
  markers << "x_m,y_m,z_m,radius_m\n";
  for (const ct::Ball& b : phantom.markers)
    markers << b.centre.x << ',' << b.centre.y << ',' << b.centre.z << ',' << b.radius << '\n';
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "ct-phantom: %s\n", e.what());
  return 70;
}
