// The other side of `scripts/experiments/ct-cleaning.mk`: a phantom, what a tomograph makes of it, and its true
// surface. usage: ct-phantom NAME VOXELS PHOTONS SEED FOLDER
//   NAME: glass-tube, hollow-sphere, bowl, teapot; writes FOLDER/volume.nrrd (uint16), FOLDER/true.ply (the glass
//   alone, in the volume's frame, metres) and FOLDER/markers.csv (true centres and
//   radii) and FOLDER/room.exr, surroundings of 30 x 15 checks that show how glass bends light.
#include <cstdio>
#include <fstream>

#include "ct/scanner.h"
#include "ct/true_surface.h"
#include "io/picture.h"
#include "io/ply.h"

namespace {

using namespace gonio;

ct::Phantom phantom_of(const std::string& name, const ct::Place& place) {
  if (name == "glass-tube") return ct::glass_tube(place);
  if (name == "hollow-sphere") return ct::hollow_sphere(place);
  if (name == "bowl") return ct::bowl_with_lid(place);
  if (name == "teapot") return ct::teapot(place);
  throw std::invalid_argument("no phantom " + name);
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
  io::write_ply(folder + "/true.ply", ct::true_surface(phantom, scanner));
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
