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
  Sweep(const SlicedBody& of, const Bounds& bounds, const PixelGrid& whole, const Rays& rays)
      : body(of),
        low(bounds.low),
        top_m(bounds.high.z),
        box(part(bounds, whole)),
        grid(grid_of(box, whole)),
        coverage(of.positions_m, of.triangles, grid, 0, rays),
        share(grid.pixels()) {}

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
  double at(int x, int y) const {  // of the whole picture
    if (x < box.x_begin || x >= box.x_end || y < box.y_begin || y >= box.y_end) return 0;
    return static_cast<double>(
        share[static_cast<std::size_t>(y - box.y_begin) * static_cast<std::size_t>(grid.width_px) +
              static_cast<std::size_t>(x - box.x_begin)]);
  }
  struct FaceAxes {
    Vec3 u{1, 0, 0}, v{0, 1, 0};
  };
  FaceAxes axes_of(std::uint32_t triangle) const;
  relief::SurfacePlace place(std::uint32_t triangle, const FaceAxes& axes, Vec2 at, double z_m) const;
  double structure_over(int x, int y, std::uint32_t triangle, double z_m, int samples) const;

  const SlicedBody& body;
  Vec3 low;
  double top_m;
  PixelBox box;
  PixelGrid grid;
  CoverageSweep coverage;
  const LayerCoverage* layer = nullptr;  // null: the body has ended
  bool ended = false;
  std::vector<float> share;  // modulated
};

Slicer::Sweep::FaceAxes Slicer::Sweep::axes_of(std::uint32_t triangle) const {
  const auto& [i, j, k] = body.triangles[triangle];
  const Vec3 one = body.positions_m[j] - body.positions_m[i], two = body.positions_m[k] - body.positions_m[i];
  const Vec3 across = cross(one, two);
  if (!(dot(across, across) > 0)) return {};
  const Vec3 n = normalized(across);
  const auto within = [&](Vec3 direction) {
    const Vec3 u = direction - n * dot(n, direction);
    if (!(dot(u, u) > 1e-12 * dot(direction, direction))) {
      const Basis any(n);
      return FaceAxes{any.t, any.b};
    }
    return FaceAxes{normalized(u), cross(n, normalized(u))};
  };
  if (body.axes == StructureAxes::platform) return within({1, 0, 0});
  if (body.axes == StructureAxes::direction) return within(body.direction);
  if (body.axes == StructureAxes::faces) return {Basis(n).t, Basis(n).b};
  const Vec2 a = body.texture[j] - body.texture[i], b = body.texture[k] - body.texture[i];
  const double turned = a.x * b.y - b.x * a.y;  // > 0: the texture is seen the right way round
  FaceAxes axes = within((one * b.y - two * a.y) * (turned < 0 ? -1.0 : 1.0));
  if (turned < 0) axes.v = axes.v * -1.0;
  return axes;
}

relief::SurfacePlace Slicer::Sweep::place(std::uint32_t triangle, const FaceAxes& axes, Vec2 at, double z_m) const {
  relief::SurfacePlace p{at, {at.x, at.y, z_m}, axes.u, axes.v};
  if (body.axes == StructureAxes::platform) return p;
  if (body.axes != StructureAxes::texture) {
    p.along_m = {dot(p.body_m, axes.u), dot(p.body_m, axes.v)};
    return p;
  }
  const auto& [i, j, k] = body.triangles[triangle];
  const Vec3 &a = body.positions_m[i], &b = body.positions_m[j], &c = body.positions_m[k];
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
  const FaceAxes axes = axes_of(triangle);
  double sum = 0;
  for (int j = 0; j < samples; ++j)
    for (int i = 0; i < samples; ++i)
      sum += structure(place(triangle, axes,
                             {grid.corner_m.x + (x + (i + 0.5) / samples) * grid.pixel_m.x,
                              grid.corner_m.y + (y + (j + 0.5) / samples) * grid.pixel_m.y},
                             z_m));
  return sum / (samples * samples);
}

Slicer::Slicer(const Printer& printer, const std::vector<SlicedBody>& bodies, int samples, const Rays& rays)
    : printer_(printer), samples_(samples) {
  const PixelGrid grid = printer.grid();
  double top_m = 0;
  for (const SlicedBody& body : bodies) {
    const Bounds b = bounds_of(body);
    check_fits(body, b, grid);
    if (body.axes == StructureAxes::texture && body.texture.size() != body.positions_m.size() && body.structured())
      throw Error(Exit::data, body.name, "has no texture coordinates", "bring a mesh with them, or other axes");
    sweeps_.push_back(std::make_unique<Sweep>(body, b, grid, rays));
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

double Slicer::modulate(Sweep& sweep) const {
  const LayerCoverage& from = *sweep.layer;
  const double thickness_m = from.top_m - from.bottom_m, pixel_m2 = printer_.pixel_m.x * printer_.pixel_m.y;
  const SlicedBody& body = sweep.body;
  std::vector<double> structured(static_cast<std::size_t>(sweep.grid.height_px));
  const auto pixel = [&](std::size_t row, int x) {
    const std::size_t k = row * static_cast<std::size_t>(sweep.grid.width_px) + static_cast<std::size_t>(x);
    double share = from.share[k];
    const auto take = [&](const LayerCoverage::Facing& facing, bool up) {
      const double area = static_cast<double>(facing.area[k]), depth = static_cast<double>(facing.depth[k]);
      if (!(area > 1e-6)) return;
      const double inward = std::clamp(depth / area, 0.0, 1.0) * thickness_m;
      const double kept = sweep.structure_over(x, static_cast<int>(row), facing.triangle[k],
                                               up ? from.bottom_m + inward : from.top_m - inward, samples_);
      share = std::max(0.0, share - std::clamp(depth, 0.0, share) * (1 - kept));
      structured[row] += area * pixel_m2;
    };
    if (body.structured()) take(from.up, true);
    if (body.structured() && body.structured_beneath) take(from.down, false);
    sweep.share[k] = static_cast<float>(share);
  };
  parallel_for(
      0, structured.size(),
      [&](std::size_t row) {
        for (const PixelRange& range : from.changed[row])
          for (int x = range[0]; x < range[1]; ++x) pixel(row, x);
      },
      16);
  double sum = 0;
  for (const double area : structured) sum += area;
  return sum;
}

// Sums over bodies where any of them changed.
void Slicer::add_up() {
  const std::size_t wide = static_cast<std::size_t>(layer_.box.x_end - layer_.box.x_begin);
  std::vector<double> shares(layer_.changed.size()), unreached(shares);
  parallel_for(
      0, layer_.changed.size(),
      [&](std::size_t row) {
        const int y = layer_.box.y_begin + static_cast<int>(row);
        std::vector<PixelRange>& changed = layer_.changed[row];
        changed.clear();
        for (const auto& sweep : sweeps_) {
          if (sweep->layer == nullptr || y < sweep->box.y_begin || y >= sweep->box.y_end) continue;
          const int move = sweep->box.x_begin - layer_.box.x_begin;
          for (const PixelRange& range : sweep->layer->changed[static_cast<std::size_t>(y - sweep->box.y_begin)])
            changed.push_back({range[0] + move, range[1] + move});
        }
        if (sweeps_.size() > 1) changed = joined(std::move(changed));
        for (const PixelRange& range : changed)
          for (int x = range[0]; x < range[1]; ++x) {
            double sum = 0;
            for (const auto& sweep : sweeps_)
              if (sweep->layer != nullptr) sum += sweep->at(layer_.box.x_begin + x, y);
            float& share = layer_.share[row * wide + static_cast<std::size_t>(x)];
            const auto now = static_cast<float>(std::min(1.0, sum));
            const double before = static_cast<double>(share), after = static_cast<double>(now);
            shares[row] += after - before;
            unreached[row] += std::max(0.0, after - reach_) - std::max(0.0, before - reach_);
            share = now;
          }
      },
      16);
  for (std::size_t row = 0; row < shares.size(); ++row) shares_ += shares[row], unreached_ += unreached[row];
}

const LayerPicture* Slicer::next() {
  const bool first = layer_.share.empty();
  if (!first) ++layer_.index;
  if (layer_.index >= layers_) return nullptr;
  layer_.bottom_m = layer_.top_m, layer_.top_m = layer_.bottom_m + printer_.thickness_m(layer_.index);
  const double thickness_m = layer_.top_m - layer_.bottom_m;
  if (first) {
    layer_.box = box();
    layer_.changed.resize(static_cast<std::size_t>(layer_.box.y_end - layer_.box.y_begin));
    layer_.share.resize(layer_.changed.size() * static_cast<std::size_t>(layer_.box.x_end - layer_.box.x_begin));
  }
  layer_.structured_m2 = layer_.excess = 0;
  for (const auto& sweep : sweeps_) {
    if (sweep->ended) {
      sweep->layer = nullptr;
      continue;
    }
    sweep->ended = layer_.bottom_m >= sweep->top_m;  // this layer is the one in which its shares end
    sweep->layer = &sweep->coverage.next(layer_.top_m);
    layer_.structured_m2 += modulate(*sweep), layer_.excess = std::max(layer_.excess, sweep->layer->excess);
  }
  const double reach = std::min(1.0, printer_.growth.reach_m(thickness_m) / thickness_m);
  if (reach != reach_) {  // another thickness
    reach_ = reach, unreached_ = 0;
    for (const float share : layer_.share) unreached_ += std::max(0.0, static_cast<double>(share) - reach_);
  }
  add_up();
  const double voxel_m3 = printer_.pixel_m.x * printer_.pixel_m.y * thickness_m;
  layer_.solid_m3 = shares_ * voxel_m3, layer_.unreached_m3 = unreached_ * voxel_m3;
  return &layer_;
}

const std::vector<std::uint8_t>& GreyPicture::of(const LayerPicture& layer) {
  const double thickness_m = layer.top_m - layer.bottom_m;
  const std::size_t wide = static_cast<std::size_t>(layer.box.x_end - layer.box.x_begin);
  const bool follows = layer.index == next_ && thickness_m == thickness_m_ && greys_.size() == layer.share.size();
  greys_.resize(layer.share.size());
  parallel_for(
      0, layer.changed.size(),
      [&](std::size_t row) {
        const auto reckon = [&](PixelRange range) {
          for (std::size_t k = row * wide + static_cast<std::size_t>(range[0]);
               k < row * wide + static_cast<std::size_t>(range[1]); ++k) {
            const double grey = printer_.growth.grey_of_share(static_cast<double>(layer.share[k]), thickness_m);
            greys_[k] = static_cast<std::uint8_t>(255 * std::clamp(grey, 0.0, 1.0) + 0.5);
          }
        };
        if (!follows) return reckon({0, static_cast<int>(wide)});
        for (const PixelRange& range : layer.changed[row]) reckon(range);
      },
      16);
  next_ = layer.index + 1, thickness_m_ = thickness_m;
  return greys_;
}

}  // namespace gonio::print
