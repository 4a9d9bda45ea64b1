// The contours of `scripts/bench volume` (scripts/bench.d/volume): a field to contour, and our side.
//   bench-volume make FILE N      N^3 voxels of 16 bit as NRRD: gyroid walls within a ball, blurred, noisy
//   bench-volume contour FILE THRESHOLD [MESH] -> seconds, seconds of processor time, triangles, MiB at the peak
//   bench-volume judge FILE THRESHOLD MESH -> root of the mean square and largest distance from the surface where the
//                                 trilinear volume has the threshold, voxels, at vertices and at centres of triangles
// MESH: a line with the counts of vertices and triangles, doubles, 32-bit indices.
#include "io/volume.h"

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "volume/contour.h"

namespace {

using gonio::io::VolumeSource;

// Walls 5 voxels thick along a gyroid within a ball, 20000 to 40000 across 3 voxels, with a noise of 90 (sd): about 5.7
// N^2 triangles.
void make(const char* file, std::size_t count) {
  std::FILE* out = std::fopen(file, "wb");
  std::fprintf(out,
               "NRRD0004\ntype: uint16\ndimension: 3\nsizes: %zu %zu %zu\nspacings: 1 1 1\nencoding: raw\n"
               "endian: little\n\n",
               count, count, count);
  const double half = static_cast<double>(count) / 2, wave = 2 * gonio::pi / (0.16 * static_cast<double>(count));
  std::vector<double> sine(count), cosine(count);
  for (std::size_t i = 0; i < count; ++i) {
    sine[i] = std::sin(wave * (static_cast<double>(i) - half));
    cosine[i] = std::cos(wave * (static_cast<double>(i) - half));
  }
  std::vector<std::uint16_t> slice(count * count);
  for (std::size_t k = 0; k < count; ++k) {
    gonio::parallel_for(0, count, [&](std::size_t j) {
      gonio::Random random(7, k * count + j);
      for (std::size_t i = 0; i < count; ++i) {
        const double gyroid = sine[i] * cosine[j] + sine[j] * cosine[k] + sine[k] * cosine[i];
        const double x = static_cast<double>(i) - half, y = static_cast<double>(j) - half,
                     z = static_cast<double>(k) - half;
        const double to_wall = 2.5 - std::abs(gyroid) / (1.2 * wave);
        const double to_ball = 0.22 * static_cast<double>(count) - std::sqrt(x * x + y * y + z * z);
        const double d = std::min(to_wall, to_ball);
        const double inside = d < -8 ? 0 : d > 8 ? 1 : 1 / (1 + std::exp(-2.4 * d));
        slice[j * count + i] = static_cast<std::uint16_t>(20000 + 20000 * inside + 300 * (random.uniform() - 0.5));
      }
    });
    std::fwrite(slice.data(), 2, slice.size(), out);
  }
  std::fclose(out);
}

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto of = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return of(usage.ru_utime) + of(usage.ru_stime);
}

void contour(const char* file, double threshold, const char* mesh) {
  const double begun = seconds(), used = processor_seconds();
  const auto source = gonio::io::open_volume(file);
  gonio::volume::ContourWish wish;
  wish.threshold = threshold;
  const gonio::volume::Contour made = gonio::volume::contour(*source, wish);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("%.3f %.3f %zu %.1f\n", seconds() - begun, processor_seconds() - used, made.triangles.size(),
              static_cast<double>(usage.ru_maxrss) / 1024);
  if (mesh == nullptr) return;
  std::ofstream out(mesh, std::ios::binary);
  out << made.positions.size() << ' ' << made.triangles.size() << '\n';
  for (const auto& p : made.positions) {
    const std::array<double, 3> wide{p[0], p[1], p[2]};
    out.write(reinterpret_cast<const char*>(wide.data()), sizeof wide);
  }
  out.write(reinterpret_cast<const char*>(made.triangles.data()),
            static_cast<std::streamsize>(made.triangles.size() * 12));
}

// |value - threshold| / |gradient| of the trilinear volume at points.
struct Judge {
  gonio::io::VolumeData volume;
  double threshold = 0, sum = 0, largest = 0;
  std::size_t count = 0;
  void add(const std::array<double, 3>& p) {
    std::array<std::size_t, 3> at{};
    std::array<double, 3> share{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double inside = std::clamp(p[a], 0.0, static_cast<double>(volume.head.size[a] - 1) - 1e-9);
      at[a] = static_cast<std::size_t>(inside);
      share[a] = inside - static_cast<double>(at[a]);
    }
    double value = 0;
    std::array<double, 3> rise{};
    for (std::size_t c = 0; c < 8; ++c) {
      const std::array<std::size_t, 3> bit{c & 1, c >> 1 & 1, c >> 2};
      std::array<double, 3> weight{};
      for (std::size_t a = 0; a < 3; ++a) weight[a] = bit[a] != 0 ? share[a] : 1 - share[a];
      const double v = volume.at(at[0] + bit[0], at[1] + bit[1], at[2] + bit[2]);
      value += weight[0] * weight[1] * weight[2] * v;
      for (std::size_t a = 0; a < 3; ++a) rise[a] += (bit[a] != 0 ? v : -v) * weight[(a + 1) % 3] * weight[(a + 2) % 3];
    }
    const double steep = std::sqrt(rise[0] * rise[0] + rise[1] * rise[1] + rise[2] * rise[2]);
    const double distance = std::abs(value - threshold) / std::max(steep, 1e-9);
    if (distance > 2) return;  // no gradient to speak of: the linear estimate says nothing
    sum += distance * distance;
    largest = std::max(largest, distance);
    ++count;
  }
};

void judge(const char* file, double threshold, const char* mesh) {
  Judge vertices{gonio::io::read_volume(file), threshold};
  std::ifstream in(mesh, std::ios::binary);
  std::size_t points = 0, triangles = 0;
  in >> points >> triangles;
  in.get();
  std::vector<std::array<double, 3>> position(points);
  std::vector<std::array<std::uint32_t, 3>> corners(triangles);
  in.read(reinterpret_cast<char*>(position.data()), static_cast<std::streamsize>(points * 24));
  in.read(reinterpret_cast<char*>(corners.data()), static_cast<std::streamsize>(triangles * 12));
  for (const auto& p : position) vertices.add(p);
  Judge centres{std::move(vertices.volume), threshold};
  for (const auto& t : corners) {
    std::array<double, 3> p{};
    for (const std::uint32_t v : t)
      for (std::size_t a = 0; a < 3; ++a) p[a] += position[v][a] / 3;
    centres.add(p);
  }
  std::printf("%.4f %.3f %.4f %.3f\n", std::sqrt(vertices.sum / vertices.count), vertices.largest,
              std::sqrt(centres.sum / centres.count), centres.largest);
}

}  // namespace

int main(int count, char** words) {
  const std::string what = count > 1 ? words[1] : "";
  const auto threshold = [&] { return std::strtod(words[3], nullptr); };
  if (what == "make" && count == 4)
    make(words[2], std::strtoul(words[3], nullptr, 10));
  else if (what == "contour" && count >= 4)
    contour(words[2], threshold(), count > 4 ? words[4] : nullptr);
  else if (what == "judge" && count == 5)
    judge(words[2], threshold(), words[4]);
  else
    return 64;
  return 0;
}
