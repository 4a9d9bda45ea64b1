// See slicer.h.
#include "print/slicer.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"

namespace gonio::print {
namespace {

struct Bounds {
  Vec3 low{}, high{};
};
Bounds bounds_of(const SlicedBody& body) {
  if (body.positions_m.empty()) return {};
  Bounds b{body.positions_m[0], body.positions_m[0]};
  for (const Vec3& p : body.positions_m) {
    b.low = {std::min(b.low.x, p.x), std::min(b.low.y, p.y), std::min(b.low.z, p.z)};
    b.high = {std::max(b.high.x, p.x), std::max(b.high.y, p.y), std::max(b.high.z, p.z)};
  }
  return b;
}

PixelBox united(const PixelBox& a, const PixelBox& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.x_begin, b.x_begin), std::min(a.y_begin, b.y_begin), std::max(a.x_end, b.x_end),
          std::max(a.y_end, b.y_end)};
}

constexpr double mm = 1e3;

void check_fits(const SlicedBody& body, const Bounds& b, const PixelGrid& grid) {
  const double half_x = grid.pixel_m.x * grid.width_px / 2, half_y = grid.pixel_m.y * grid.height_px / 2, slack = 1e-9;
  if (b.low.x < -half_x - slack || b.high.x > half_x + slack || b.low.y < -half_y - slack || b.high.y > half_y + slack)
    throw Error(
        Exit::data, body.name,
        format("reaches from %.4g to %.4g mm in x and %.4g to %.4g mm in y, the printer's picture %.4g x %.4g mm",
               b.low.x * mm, b.high.x * mm, b.low.y * mm, b.high.y * mm, 2 * half_x * mm, 2 * half_y * mm),
        "move it, scale it, or take a printer with a larger picture");
  if (b.low.z < -slack)
    throw Error(Exit::data, body.name, format("reaches %.4g mm below the platform", -b.low.z * mm), "set it down");
}

}  // namespace

void snap_to_layers(SlicedBody& body, const Printer& printer, double bottom_m, double tolerance) {
  const double highest = bounds_of(body).high.z;
  std::vector<double> borders{bottom_m};
  while (borders.back() < highest + printer.layer_m)
    borders.push_back(borders.back() + printer.thickness_m(borders.size() - 1));
  for (Vec3& p : body.positions_m) {
    const auto above = std::ranges::lower_bound(borders, p.z);
    const auto near = [&](double border, double thickness) {
      if (std::abs(p.z - border) <= tolerance * thickness) p.z = border;
    };
    const auto k = static_cast<std::size_t>(above - borders.begin());
    if (above != borders.end()) near(*above, printer.thickness_m(k > 0 ? k - 1 : 0));
    if (above != borders.begin()) near(*(above - 1), printer.thickness_m(k - 1));
  }
}

// One body over its own part of the picture.
struct Slicer::Sweep {
  Sweep(const SlicedBody& of, const Bounds& bounds, const PixelGrid& whole)
      : body(of),
        low(bounds.low),
        top_m(bounds.high.z),
        box(part(bounds, whole)),
        grid(grid_of(box, whole)),
        coverage(of.positions_m, of.triangles, grid, 0) {}

  static PixelBox part(const Bounds& b, const PixelGrid& whole) {
    const auto pixel = [](double m, double corner, double size, int count, bool end) {
      const double at = (m - corner) / size;
      return std::clamp(static_cast<int>(end ? std::ceil(at) : std::floor(at)), 0, count);
    };
    return {pixel(b.low.x, whole.corner_m.x, whole.pixel_m.x, whole.width_px, false),
            pixel(b.low.y, whole.corner_m.y, whole.pixel_m.y, whole.height_px, false),
            pixel(b.high.x, whole.corner_m.x, whole.pixel_m.x, whole.width_px, true),
            pixel(b.high.y, whole.corner_m.y, whole.pixel_m.y, whole.height_px, true)};
  }
  static PixelGrid grid_of(const PixelBox& box, const PixelGrid& whole) {
    return {.width_px = box.x_end - box.x_begin,
            .height_px = box.y_end - box.y_begin,
            .pixel_m = whole.pixel_m,
            .corner_m = {whole.corner_m.x + box.x_begin * whole.pixel_m.x,
                         whole.corner_m.y + box.y_begin * whole.pixel_m.y}};
  }

  const relief::ShareAt& structure_of(std::uint32_t triangle) const {
    if (!body.labels.empty())
      if (const auto found = body.by_label.find(body.labels[triangle]); found != body.by_label.end())
        return found->second;
    return body.structure;
  }
  relief::SurfacePlace place(std::uint32_t triangle, Vec2 at, double z_m) const;
  double structure_over(int x, int y, std::uint32_t triangle, double z_m, int samples) const;

  const SlicedBody& body;
  Vec3 low;
  double top_m;
  PixelBox box;
  PixelGrid grid;
  CoverageSweep coverage;
  const LayerCoverage* layer = nullptr;
};

relief::SurfacePlace Slicer::Sweep::place(std::uint32_t triangle, Vec2 at, double z_m) const {
  relief::SurfacePlace p{at, {at.x, at.y, z_m}};
  if (body.axes == StructureAxes::platform) return p;
  const auto& [i, j, k] = body.triangles[triangle];
  const Vec3 &a = body.positions_m[i], &b = body.positions_m[j], &c = body.positions_m[k];
  if (body.axes == StructureAxes::faces) {
    const Vec3 normal = cross(b - a, c - a);
    if (!(dot(normal, normal) > 0)) return p;
    const Basis basis(normalized(normal));
    p.along_m = {dot(p.body_m, basis.t), dot(p.body_m, basis.b)};
    return p;
  }
  const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (area == 0) return p;
  const double s = ((at.x - a.x) * (c.y - a.y) - (at.y - a.y) * (c.x - a.x)) / area;
  const double t = ((b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x)) / area;
  const Vec2 &ta = body.texture[i], &tb = body.texture[j], &tc = body.texture[k];
  p.along_m = {body.texture_m * (ta.x + s * (tb.x - ta.x) + t * (tc.x - ta.x)),
               body.texture_m * (ta.y + s * (tb.y - ta.y) + t * (tc.y - ta.y))};
  return p;
}

double Slicer::Sweep::structure_over(int x, int y, std::uint32_t triangle, double z_m, int samples) const {
  const relief::ShareAt& structure = structure_of(triangle);
  if (!structure) return 1;
  double sum = 0;
  for (int j = 0; j < samples; ++j)
    for (int i = 0; i < samples; ++i)
      sum += structure(place(triangle,
                             {grid.corner_m.x + (x + (i + 0.5) / samples) * grid.pixel_m.x,
                              grid.corner_m.y + (y + (j + 0.5) / samples) * grid.pixel_m.y},
                             z_m));
  return sum / (samples * samples);
}

Slicer::Slicer(const Printer& printer, const std::vector<SlicedBody>& bodies, int samples)
    : printer_(printer), samples_(samples) {
  const PixelGrid grid = printer.grid();
  double top_m = 0;
  for (const SlicedBody& body : bodies) {
    const Bounds b = bounds_of(body);
    check_fits(body, b, grid);
    if (body.axes == StructureAxes::texture && body.texture.size() != body.positions_m.size() && body.structured())
      throw Error(Exit::data, body.name, "has no texture coordinates", "bring a mesh with them, or other axes");
    sweeps_.push_back(std::make_unique<Sweep>(body, b, grid));
    top_m = std::max(top_m, b.high.z);
  }
  for (double z = 0; z < top_m - 1e-6 * printer.layer_m; ++layers_) z += printer.thickness_m(layers_);
}
Slicer::~Slicer() = default;

PixelBox Slicer::box() const {
  PixelBox all;
  for (const auto& sweep : sweeps_) all = united(all, sweep->box);
  return all;
}

void Slicer::add(const Sweep& sweep, LayerPicture& layer) const {
  const LayerCoverage& from = *sweep.layer;
  const int wide = layer.box.x_end - layer.box.x_begin;
  const double thickness_m = layer.top_m - layer.bottom_m, pixel_m2 = printer_.pixel_m.x * printer_.pixel_m.y;
  const SlicedBody& body = sweep.body;
  std::vector<double> structured(static_cast<std::size_t>(sweep.grid.height_px));
  parallel_for(
      0, static_cast<std::size_t>(sweep.grid.height_px),
      [&](std::size_t row) {
        const std::size_t first = row * static_cast<std::size_t>(sweep.grid.width_px);
        float* const to = layer.share.data() + (row + static_cast<std::size_t>(sweep.box.y_begin - layer.box.y_begin)) *
                                                   static_cast<std::size_t>(wide);
        for (int x = from.box.x_begin; x < from.box.x_end; ++x) {
          const std::size_t k = first + static_cast<std::size_t>(x);
          double share = from.share[k];
          const auto modulate = [&](const LayerCoverage::Facing& facing, bool up) {
            const double area = static_cast<double>(facing.area[k]), depth = static_cast<double>(facing.depth[k]);
            if (!(area > 1e-6)) return;
            const double inward = std::clamp(depth / area, 0.0, 1.0) * thickness_m;
            const double kept = sweep.structure_over(x, static_cast<int>(row), facing.triangle[k],
                                                     up ? layer.bottom_m + inward : layer.top_m - inward, samples_);
            share = std::max(0.0, share - std::clamp(depth, 0.0, share) * (1 - kept));
            structured[row] += area * pixel_m2;
          };
          if (body.structured()) modulate(from.up, true);
          if (body.structured() && body.structured_beneath) modulate(from.down, false);
          float& target = to[x + sweep.box.x_begin - layer.box.x_begin];
          target = static_cast<float>(std::min(1.0, static_cast<double>(target) + share));
        }
      },
      16);
  for (const double area : structured) layer.structured_m2 += area;
  layer.excess = std::max(layer.excess, from.excess);
}

bool Slicer::next(LayerPicture& layer) {
  if (index_ >= layers_) return false;
  layer = {.index = index_, .bottom_m = bottom_m_, .top_m = bottom_m_ + printer_.thickness_m(index_)};
  for (const auto& sweep : sweeps_) {
    sweep->layer = layer.bottom_m < sweep->top_m ? &sweep->coverage.next(layer.top_m) : nullptr;
    if (sweep->layer == nullptr) continue;
    layer.box = united(layer.box, sweep->box);
  }
  layer.share.assign(static_cast<std::size_t>(layer.box.x_end - layer.box.x_begin) *
                         static_cast<std::size_t>(layer.box.y_end - layer.box.y_begin),
                     0);
  for (const auto& sweep : sweeps_)
    if (sweep->layer != nullptr) add(*sweep, layer);
  const double voxel_m3 = printer_.pixel_m.x * printer_.pixel_m.y * (layer.top_m - layer.bottom_m);
  const double reach =
      std::min(1.0, printer_.growth.reach_m(layer.top_m - layer.bottom_m) / (layer.top_m - layer.bottom_m));
  for (const float share : layer.share) {
    layer.solid_m3 += static_cast<double>(share) * voxel_m3;
    layer.unreached_m3 += std::max(0.0, static_cast<double>(share) - reach) * voxel_m3;
  }
  ++index_, bottom_m_ = layer.top_m;
  return true;
}

std::vector<std::uint8_t> greys_of(const LayerPicture& layer, const Printer& printer) {
  const double thickness_m = layer.top_m - layer.bottom_m;
  std::vector<std::uint8_t> greys(layer.share.size());
  parallel_for(
      0, greys.size(),
      [&](std::size_t k) {
        const double grey = printer.growth.grey(static_cast<double>(layer.share[k]) * thickness_m, thickness_m);
        greys[k] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(grey, 0.0, 1.0)));
      },
      4096);
  return greys;
}

}  // namespace gonio::print
