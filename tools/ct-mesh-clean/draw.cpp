// Slices of the volume in three planes through its middle, with the contour (blue) and the cleaned mesh (orange) over
// them.
#include <algorithm>
#include <cmath>

#include "io/image.h"
#include "io/raster.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {
namespace {

constexpr std::size_t most_px = 640;
using Colour = std::array<float, 3>;

// One plane: pixels along index axes u and v, `across` fixed. z slices look along k, and so on.
struct Plane {
  std::size_t u, v, across;
  std::size_t at = 0;
  std::size_t step = 1;  // voxels per pixel
  std::size_t width = 0, height = 0;
  double enlarge = 1;  // pixels per voxel where the volume is small
  std::vector<float> values{};
  const char* name;
};

Plane plane_of(const io::VolumeHead& head, std::size_t u, std::size_t v, std::size_t across, std::size_t at,
               const char* name) {
  Plane p{.u = u, .v = v, .across = across, .at = at, .name = name};
  p.step = std::max<std::size_t>(1, (std::max(head.size[u], head.size[v]) + most_px - 1) / most_px);
  p.width = (head.size[u] + p.step - 1) / p.step, p.height = (head.size[v] + p.step - 1) / p.step;
  p.enlarge = static_cast<double>(std::max<std::size_t>(1, most_px / std::max(p.width, p.height)));
  p.values.assign(p.width * p.height, 0);
  return p;
}

void take_slice(std::vector<Plane>& planes, const io::VolumeHead& head, std::size_t k,
                const std::vector<float>& slice) {
  for (Plane& p : planes)
    for (std::size_t y = 0; y < p.height; ++y)
      for (std::size_t x = 0; x < p.width; ++x) {
        std::array<std::size_t, 3> index{};
        index[p.u] = x * p.step, index[p.v] = y * p.step, index[p.across] = p.at;
        if (index[2] == k) p.values[y * p.width + x] = slice[index[1] * head.size[0] + index[0]];
      }
}

// A slice through the middle of what stays, so that it shows the object.
std::array<std::size_t, 3> middle(const Work& work) {
  const volume::Component* largest = nullptr;
  for (std::size_t c = 0; c < work.components.list.size() && largest == nullptr; ++c)
    if (work.kept.keep[c]) largest = &work.components.list[c];
  std::array<std::size_t, 3> at{};
  for (std::size_t i = 0; i < 3; ++i)
    at[i] = largest == nullptr ? work.file->head().size[i] / 2 : (largest->low[i] + largest->high[i]) / 2;
  return at;
}

void line(io::Image& image, double x0, double y0, double x1, double y1, const Colour& colour) {
  const int n = std::max(1, static_cast<int>(std::ceil(2 * std::hypot(x1 - x0, y1 - y0))));
  for (int i = 0; i <= n; ++i) {
    const int x = static_cast<int>(std::lround(x0 + (x1 - x0) * i / n)),
              y = static_cast<int>(std::lround(y0 + (y1 - y0) * i / n));
    if (x < 0 || y < 0 || x >= image.width || y >= image.height) continue;
    for (int dy = 0; dy < 2; ++dy)
      for (int dx = 0; dx < 2; ++dx)
        for (int c = 0; c < 3; ++c)
          image.at(std::min(x + dx, image.width - 1), std::min(y + dy, image.height - 1), c) =
              colour[static_cast<std::size_t>(c)];
  }
}

// k points up in the pictures that show it, j down in the one that does not.
io::Image upright(io::Image image, const Plane& p) {
  if (p.v != 2) return image;
  io::Image turned = image;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 3; ++c) turned.at(x, image.height - 1 - y, c) = image.at(x, y, c);
  return turned;
}

// Index coordinates of a point in metres.
std::array<double, 3> index_of(const Work& work, Vec3 p) {
  const Vec3 at = work.grid.index(p);
  return {at.x, at.y, at.z};
}

void outline(io::Image& image, const Plane& p, const Work& work, const io::TriangleMesh& mesh, const Colour& colour) {
  const double level = static_cast<double>(p.at) + 1e-6;  // vertices at voxel centres are no special case
  for (const auto& t : mesh.triangles) {
    std::array<std::array<double, 3>, 3> corner;
    for (std::size_t c = 0; c < 3; ++c) corner[c] = index_of(work, mesh.positions_m[t[c]]);
    std::array<std::array<double, 2>, 2> ends;
    std::size_t found = 0;
    for (std::size_t c = 0; c < 3 && found < 2; ++c) {
      const auto &a = corner[c], &b = corner[(c + 1) % 3];
      if ((a[p.across] > level) == (b[p.across] > level)) continue;
      const double s = (level - a[p.across]) / (b[p.across] - a[p.across]);
      const double scale = p.enlarge / static_cast<double>(p.step), half = 0.5 * (p.enlarge - 1);
      ends[found++] = {scale * (a[p.u] + s * (b[p.u] - a[p.u])) + half,
                       scale * (a[p.v] + s * (b[p.v] - a[p.v])) + half};
    }
    if (found == 2) line(image, ends[0][0], ends[0][1], ends[1][0], ends[1][1], colour);
  }
}

io::Image grey(const Plane& p, double low, double high) {
  const int factor = static_cast<int>(p.enlarge);
  io::Image image(static_cast<int>(p.width) * factor, static_cast<int>(p.height) * factor, {"R", "G", "B"});
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const float v = p.values[static_cast<std::size_t>(y / factor) * p.width + static_cast<std::size_t>(x / factor)];
      const float shown = static_cast<float>(std::clamp((v - low) / (high - low), 0.0, 1.0));
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = shown;
    }
  return image;
}

// Values that 0.5 % of the voxels are below, and 0.05 % above: objects are small beside the air round them.
std::pair<double, double> range_of(const volume::Histogram& h) {
  std::uint64_t all = 0;
  for (const std::uint64_t n : h.counts) all += n;
  const double bin = (h.high - h.low) / static_cast<double>(std::max<std::size_t>(1, h.counts.size()));
  const auto percentile = [&](double share) {
    double left = share * static_cast<double>(all);
    for (std::size_t b = 0; b < h.counts.size(); ++b)
      if ((left -= static_cast<double>(h.counts[b])) <= 0) return h.low + (static_cast<double>(b) + 0.5) * bin;
    return h.high;
  };
  const double low = percentile(0.005), high = percentile(0.9995);
  return high > low ? std::pair{low, high} : std::pair{h.smallest, std::max(h.largest, h.smallest + 1e-30)};
}

}  // namespace

void draw(Work& work) {
  const io::VolumeHead& head = work.file->head();
  const std::array<std::size_t, 3> at = middle(work);
  std::vector<Plane> planes{plane_of(head, 0, 1, 2, at[2], "k"), plane_of(head, 0, 2, 1, at[1], "j"),
                            plane_of(head, 1, 2, 0, at[0], "i")};
  std::vector<float> slice(head.size[0] * head.size[1]);
  for (std::size_t k = 0; k < head.size[2]; ++k) {
    work.file->read(k, 1, slice);
    take_slice(planes, head, k, slice);
  }
  const auto [low, high] = range_of(work.look.histogram);
  for (const Plane& p : planes) {
    io::Image image = grey(p, low, high);
    outline(image, p, work, work.data, {0.1f, 0.45f, 1.0f});
    if (work.asked.clean != CleanBy::none || !work.markers.found.empty())
      outline(image, p, work, work.mesh, {1.0f, 0.6f, 0.05f});
    work.pictures.push_back({.step = p.across == 2 ? "surface" : "",
                             .title = std::string("slice ") + p.name + " " + std::to_string(p.at),
                             .caption = "Blue: the surface where the data put it. Orange: the cleaned mesh.",
                             .png = io::encode_raster_png(upright(std::move(image), p))});
  }
}

}  // namespace gonio::tools::ct_mesh_clean
