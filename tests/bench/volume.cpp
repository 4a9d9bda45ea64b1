// The contours of `scripts/bench volume` (scripts/bench.d/volume): a field to contour, and our side.
//   bench-volume make FILE N      N^3 voxels of 16 bit as NRRD: gyroid walls within a ball, blurred, noisy
//   bench-volume contour FILE THRESHOLD -> seconds, vertices, triangles, split polygons, MiB at the peak
#include "io/volume.h"

#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "volume/contour.h"

namespace {

using gonio::io::VolumeSource;

// Distance to the walls, voxels, about: a gyroid of walls 5 voxels thick, cut by a ball.
double field(double x, double y, double z, double count) {
  const double wave = 2 * gonio::pi / (0.16 * count);
  const double gyroid = std::sin(wave * x) * std::cos(wave * y) + std::sin(wave * y) * std::cos(wave * z) +
                        std::sin(wave * z) * std::cos(wave * x);
  const double wall = 2.5 - std::abs(gyroid) / (1.2 * wave);
  const double ball = 0.22 * count - std::sqrt(x * x + y * y + z * z);
  return std::min(wall, ball);
}

void make(const char* file, std::size_t count) {
  std::FILE* out = std::fopen(file, "wb");
  std::fprintf(
      out,
      "NRRD0004\ntype: uint16\ndimension: 3\nsizes: %zu %zu %zu\nspacings: 1 1 1\nencoding: raw\nendian: little\n\n",
      count, count, count);
  std::vector<std::uint16_t> slice(count * count);
  const double half = static_cast<double>(count) / 2;
  for (std::size_t k = 0; k < count; ++k) {
    gonio::parallel_for(0, count, [&](std::size_t j) {
      gonio::Random random(7, k * count + j);
      for (std::size_t i = 0; i < count; ++i) {
        const double d = field(i - half, j - half, k - half, static_cast<double>(count));
        const double smooth = 20000 + 20000 / (1 + std::exp(-2.4 * d));
        slice[j * count + i] = static_cast<std::uint16_t>(smooth + 300 * (random.uniform() - 0.5));
      }
    });
    std::fwrite(slice.data(), 2, slice.size(), out);
  }
  std::fclose(out);
}

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void contour(const char* file, double threshold) {
  const double begun = seconds();
  const auto source = gonio::io::open_volume(file);
  gonio::volume::ContourWish wish;
  wish.threshold = threshold;
  const gonio::volume::Contour made = gonio::volume::contour(*source, wish);
  const double took = seconds() - begun;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("%.3f %zu %zu %zu %.1f\n", took, made.positions.size(), made.triangles.size(), made.split_polygons,
              static_cast<double>(usage.ru_maxrss) / 1024);
}

}  // namespace

int main(int count, char** words) {
  if (count == 4 && std::strcmp(words[1], "make") == 0)
    make(words[2], std::strtoul(words[3], nullptr, 10));
  else if (count == 4 && std::strcmp(words[1], "contour") == 0)
    contour(words[2], std::strtod(words[3], nullptr));
  else
    return 64;
}
