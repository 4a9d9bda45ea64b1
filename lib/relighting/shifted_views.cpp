#include "relighting/shifted_views.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/parallel.h"
#include "relighting/sight.h"
#include "scene/mechanisms.h"

namespace gonio::relighting {
namespace {

constexpr int around_px = 2;       // within which near and far things are told apart
constexpr double apart = 1.01;     // ratio of depths of two things
constexpr float nowhere_m = 1e6f;  // depth of the sky
constexpr double most_px = 16;     // that a pixel's look moves
constexpr double slope_px = 0.35;  // half the width of a difference that stands for a slope: cells end within it

struct Shifted final : Prepared {
  std::shared_ptr<const FineViews> fine;
  std::shared_ptr<const Places> places;
  std::shared_ptr<const EdgeSlopes> edges;
};

// Where pixels of the view look under one set of amounts.
class Look {
 public:
  Look(const Use& use, const Frame& frame, std::span<const double> amounts, Recolour recolour)
      : view_(frame.model.recordings().views[frame.image.view]),
        camera_from_world_(inverse(view_.world_from_camera)),
        moved_{.image = frame.image.id,
               .camera = view_.model,
               .world_from_camera = view_.world_from_camera,
               .camera_name = view_.camera},
        amounts_(amounts),
        recolour_(recolour) {
    if (!recolour) scene::apply_amounts(moved_, *use.mechanism, {amounts.begin(), amounts.end()});
    camera_from_moved_ = camera_from_world_ * moved_.world_from_camera;
  }
  bool colours_part() const { return recolour_ != nullptr; }

  Vec2 at(Vec2 pixel, double depth_m, std::size_t channel) const {
    if (recolour_) return near(pixel, recolour_(view_.model, amounts_, pixel, channel));
    const camera::Ray ray = moved_.camera.ray(pixel);
    const Vec3 direction = camera_from_moved_.rotate(ray.direction), origin = camera_from_moved_ * ray.origin_m;
    if (!(direction.z > 0)) return pixel;
    const auto seen = view_.model.project(origin + direction * ((depth_m - origin.z) / direction.z));
    return seen ? near(pixel, *seen) : pixel;
  }

 private:
  static Vec2 near(Vec2 pixel, Vec2 seen) {
    const Vec2 d = seen - pixel;
    const double length = norm(d);
    if (!(length > most_px)) return seen;
    return pixel + d * (most_px / length);
  }
  const View& view_;
  Rigid<frame::Camera, frame::World> camera_from_world_;
  scene::View moved_;
  Rigid<frame::Camera, frame::Camera> camera_from_moved_;
  std::span<const double> amounts_;
  Recolour recolour_;
};

// What one pixel looks at: at one place where all things and colours go together.
struct Aims {
  std::array<Vec2, 3> at;  // by channel; or near, far
  bool parted = false;     // near and far
};

Vec2 place_of(const Pixel& pixel) {
  return {static_cast<double>(pixel.x), static_cast<double>(pixel.y)};
}

Aims aims_of(const Look& look, const Pixel& pixel, const Places::Depths& depths) {
  const Vec2 p = place_of(pixel);
  if (look.colours_part()) return {{look.at(p, 1, 0), look.at(p, 1, 1), look.at(p, 1, 2)}, false};
  const Vec2 near = look.at(p, depths.near_m, 0);
  if (depths.split_m == 0) return {{near, near, near}, false};
  const Vec2 far = look.at(p, depths.far_m, 0);
  return {{near, far, far}, norm(far - near) > 1e-9};
}

Rgb seen_at(Sight& sight, const Aims& aims, std::uint32_t pixel, bool colours_part) {
  using Which = Sight::Which;
  if (!colours_part && !aims.parted) return sight.at(aims.at[0], pixel, Which::all).radiance;
  if (colours_part) {
    Rgb sum;
    sum.x = sight.at(aims.at[0], pixel, Which::all).radiance.x;
    sum.y = sight.at(aims.at[1], pixel, Which::all).radiance.y;
    sum.z = sight.at(aims.at[2], pixel, Which::all).radiance.z;
    return sum;
  }
  const Sight::Sum near = sight.at(aims.at[0], pixel, Which::near), far = sight.at(aims.at[1], pixel, Which::far);
  const double uncovered = std::max(0.0, 1 - near.share);
  if (uncovered < 1e-9) return near.radiance;
  if (far.share > 0.02) return near.radiance + far.radiance * (uncovered / far.share);
  return sight.at(aims.at[0], pixel, Which::all).radiance;
}

// Pictures of one frame under several sets of amounts.
class Pictures {
 public:
  Pictures(const Use& use, const Frame& frame, Recolour recolour)
      : use_(use),
        frame_(frame),
        recolour_(recolour),
        prepared_(static_cast<const Shifted&>(*use.prepared)),
        sight_((*prepared_.fine)[frame.image.view], *prepared_.places, frame) {}

  void enter(std::span<const double> amounts) {
    const Look look(use_, frame_, amounts, recolour_);
    std::vector<Aims>& aims = aims_.emplace_back();
    for (const std::uint32_t p : frame_.picked) {
      aims.push_back(aims_of(look, frame_.cache.pixels[p], prepared_.places->depths[frame_.image.view][p]));
      for (const Vec2 at : aims.back().at) sight_.look_at(at);
    }
  }
  void enter_plain() {
    std::vector<Aims>& aims = aims_.emplace_back();
    for (const std::uint32_t p : frame_.picked) {
      const Vec2 at = place_of(frame_.cache.pixels[p]);
      aims.push_back({{at, at, at}, false});
      sight_.look_at(at);
    }
  }
  void shade() { sight_.shade(); }
  // Adds weight * (picture number `which`).
  void add(std::size_t which, double weight, std::span<double> out) {
    for (std::size_t i = 0; i < frame_.picked.size(); ++i) {
      const std::uint32_t p = frame_.picked[i];
      const Rgb seen = seen_at(sight_, aims_[which][i], p, recolour_ != nullptr) *
                       exposure_of(frame_.state, frame_.image, frame_.number, frame_.cache.pixels[p]);
      for (std::size_t c = 0; c < 3; ++c) out[3 * i + c] += weight * seen[static_cast<int>(c)];
    }
  }

 private:
  const Use& use_;
  const Frame& frame_;
  Recolour recolour_;
  const Shifted& prepared_;
  Sight sight_;
  std::vector<std::vector<Aims>> aims_;
};

// Near and far about a pixel: depths within `around_px`, parted at their widest gap, near ones counting more.
Places::Depths depths_about(const FineView& view, const Pixel& pixel) {
  struct Seen {
    float depth_m;
    double weight;
  };
  std::vector<Seen> seen;
  for (int v = -2 * around_px; v < 2 * around_px + 2; ++v)
    for (int u = -2 * around_px; u < 2 * around_px + 2; ++u) {
      const FineView::Place place = view.place_of(2 * pixel.x + u, 2 * pixel.y + v);
      const FineTile& tile = view.tile(place.tile);
      const Pixel& cell = tile.cells.pixels[static_cast<std::size_t>(place.cell)];
      const double weight = 1 / (1 + (u - 0.5) * (u - 0.5) + (v - 0.5) * (v - 0.5));
      for (std::uint32_t f = cell.first_facet; f < cell.first_facet + cell.facets; ++f)
        seen.push_back({tile.depth_m[f], weight * tile.cells.facets[f].weight});
      if (cell.sky > 0) seen.push_back({nowhere_m, weight * cell.sky});
    }
  std::ranges::sort(seen, {}, &Seen::depth_m);
  std::size_t gap = 0;
  double widest = apart;
  for (std::size_t i = 1; i < seen.size(); ++i)
    if (seen[i].depth_m > widest * seen[i - 1].depth_m) widest = seen[i].depth_m / seen[i - 1].depth_m, gap = i;
  const auto mean = [&](std::size_t first, std::size_t last) {
    double sum = 0, weights = 0;
    for (std::size_t i = first; i < last; ++i) sum += seen[i].weight * seen[i].depth_m, weights += seen[i].weight;
    return static_cast<float>(weights > 0 ? sum / weights : nowhere_m);
  };
  if (gap == 0) return {mean(0, seen.size()), 0, 0};
  return {mean(0, gap), mean(gap, seen.size()), std::sqrt(seen[gap - 1].depth_m * seen[gap].depth_m)};
}

// The facet that shows a surface nearest to the middle of a block.
std::vector<std::uint32_t> nearest_facets(const ViewCache& cache, int width_px, int height_px, std::size_t surfaces) {
  const int across = blocks_across(width_px), down = blocks_across(height_px);
  std::vector<std::uint32_t> nearest(static_cast<std::size_t>(across) * static_cast<std::size_t>(down) * surfaces,
                                     0xffffffffu);
  std::vector<double> least(nearest.size(), 1e30);
  for (const Pixel& pixel : cache.pixels)
    for (std::uint32_t f = pixel.first_facet; f < pixel.first_facet + pixel.facets; ++f)
      for (int b = 0; b < across * down; ++b) {
        const double x = (b % across + 0.5) * block_px - pixel.x, y = (b / across + 0.5) * block_px - pixel.y;
        const std::size_t slot = static_cast<std::size_t>(b) * surfaces + cache.facets[f].surface;
        if (x * x + y * y < least[slot]) least[slot] = x * x + y * y, nearest[slot] = f;
      }
  return nearest;
}

std::shared_ptr<const Places> find_places(const Setting& s, const FineViews& fine) {
  auto places = std::make_shared<Places>();
  for (std::size_t v = 0; v < s.recordings.views.size(); ++v) {
    const std::vector<Pixel>& pixels = s.model.cache(v).pixels;
    std::set<int> tiles;
    for (const Pixel& p : pixels)
      for (int j = -2 * around_px; j <= 2 * around_px + 1; j += 2)
        for (int i = -2 * around_px; i <= 2 * around_px + 1; i += 2)
          tiles.insert(fine[v].place_of(2 * p.x + i, 2 * p.y + j).tile);
    const std::vector<int> needed(tiles.begin(), tiles.end());
    parallel_for(
        0, needed.size(), [&](std::size_t i) { fine[v].tile(needed[i]); }, 4);
    std::vector<Places::Depths>& depths = places->depths.emplace_back(pixels.size());
    parallel_for(
        0, pixels.size(), [&](std::size_t p) { depths[p] = depths_about(fine[v], pixels[p]); }, 16);
    const camera::CameraModel& camera = s.recordings.views[v].model;
    places->nearest.push_back(
        nearest_facets(s.model.cache(v), camera.width_px(), camera.height_px(), s.layout.surfaces.size()));
  }
  return places;
}

}  // namespace

std::shared_ptr<const Prepared> prepare_shifted(const Setting& s, const Use&) {
  Shared own;
  Shared& shared = s.shared ? *s.shared : own;
  if (!shared.fine)
    shared.fine = std::make_shared<FineViews>(s.scene, s.caster, s.recordings, s.layout.lights, s.model.monomials());
  if (!shared.places) shared.places = find_places(s, *shared.fine);
  if (!shared.edges) {
    shared.edges = std::make_shared<EdgeSlopes>();
    shared.edges->of_image.resize(s.recordings.images.size());
  }
  auto result = std::make_shared<Shifted>();
  result->fine = shared.fine, result->places = shared.places, result->edges = shared.edges;
  return result;
}

std::span<const double> amounts_for(const Use& use, const Frame& frame) {
  const auto by_name = [&](const std::string& name) -> std::span<const double> {
    const auto found = std::find(use.on.begin(), use.on.end(), name);
    if (found == use.on.end()) return {};
    return use.amounts(frame.state, static_cast<std::size_t>(found - use.on.begin()));
  };
  if (use.on.empty()) return use.amounts(frame.state);
  const auto own = by_name(frame.image.id);
  return own.empty() ? by_name(frame.model.recordings().views[frame.image.view].camera) : own;
}

void add_shifted(const Use& use, const Frame& frame, std::span<double> radiance, Recolour recolour) {
  const std::span<const double> amounts = amounts_for(use, frame);
  if (amounts.empty()) return;
  Pictures pictures(use, frame, recolour);
  pictures.enter(amounts);
  pictures.enter_plain();
  pictures.shade();
  pictures.add(0, 1, radiance);
  pictures.add(1, -1, radiance);
}

namespace {

// Half the width of the difference that stands for the slope of each number; 0: it does not act on the frame's picture.
std::vector<double> half_widths(const Use& use, const Frame& frame, std::span<const std::size_t> numbers,
                                std::span<const double> amounts) {
  const std::size_t count = use.mechanism->parameters.size();
  std::vector<double> half(numbers.size(), 0.0);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Number& number = use.numbers[numbers[i]];
    if (use.amounts(frame.state, use.sets == 1 ? 0 : numbers[i] / count).data() != amounts.data()) continue;
    half[i] = slope_px / 0.5 * std::abs(number.start - number.neutral);
    if (half[i] == 0) half[i] = 1e-3 * (number.upper - number.lower);
  }
  return half;
}

// Are the amounts no further from neutral than where the search begins?
bool at_the_beginning(const Use& use, std::span<const double> amounts) {
  for (std::size_t k = 0; k < amounts.size(); ++k) {
    const Number& n = use.numbers[k];
    if (std::abs(amounts[k] - n.neutral) > 1.001 * std::abs(n.start - n.neutral)) return false;
  }
  return true;
}

void slopes_from_edges(const Use& use, const Frame& frame, std::span<const std::size_t> numbers,
                       std::span<const double> half, std::span<const double> amounts, Recolour recolour,
                       std::span<double> columns) {
  const auto& prepared = static_cast<const Shifted&>(*use.prepared);
  const std::vector<double>& edges = prepared.edges->of_image[frame.number];
  const std::vector<Places::Depths>& depths = prepared.places->depths[frame.image.view];
  const std::size_t rows = 3 * frame.picked.size(), count = use.mechanism->parameters.size();
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    if (half[n] == 0) continue;
    std::vector<double> more(amounts.begin(), amounts.end()), less = more;
    more[numbers[n] % count] += half[n], less[numbers[n] % count] -= half[n];
    const Look one(use, frame, more, recolour), other(use, frame, less, recolour);
    for (std::size_t i = 0; i < frame.picked.size(); ++i) {
      const std::uint32_t p = frame.picked[i];
      const Aims a = aims_of(one, frame.cache.pixels[p], depths[p]),
                 b = aims_of(other, frame.cache.pixels[p], depths[p]);
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec2 moved = a.parted || b.parted ? a.at[0] - b.at[0] : a.at[c] - b.at[c];
        columns[n * rows + 3 * i + c] = (edges[6 * i + c] * moved.x + edges[6 * i + 3 + c] * moved.y) / (2 * half[n]);
      }
    }
  }
}

}  // namespace

void shifted_slopes(const Use& use, const Frame& frame, std::span<const std::size_t> numbers, std::span<double> columns,
                    Recolour recolour) {
  std::fill(columns.begin(), columns.end(), 0.0);
  const std::span<const double> amounts = amounts_for(use, frame);
  if (amounts.empty()) return;
  const std::size_t rows = 3 * frame.picked.size(), count = use.mechanism->parameters.size();
  const std::vector<double> half = half_widths(use, frame, numbers, amounts);
  const EdgeSlopes& edges = *static_cast<const Shifted&>(*use.prepared).edges;
  if (at_the_beginning(use, amounts) && edges.of_image[frame.number].size() == 2 * rows)
    return slopes_from_edges(use, frame, numbers, half, amounts, recolour, columns);
  Pictures pictures(use, frame, recolour);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t k = numbers[i] % count;
    for (const double side : {1.0, -1.0}) {
      std::vector<double> there(amounts.begin(), amounts.end());
      there[k] += side * half[i];
      pictures.enter(there);
    }
  }
  pictures.shade();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (half[i] == 0) continue;
    pictures.add(2 * i, 0.5 / half[i], columns.subspan(i * rows, rows));
    pictures.add(2 * i + 1, -0.5 / half[i], columns.subspan(i * rows, rows));
  }
}

Term shifted_term(const mechanism::Mechanism& (*mechanism)(), std::vector<Use> (*candidates)(const Setting&)) {
  return {.mechanism = mechanism,
          .reach = Reach::add,
          .order = -10,
          .candidates = candidates,
          .prepare = prepare_shifted,
          .add = [](const Use& use, const Frame& frame,
                    std::span<double> radiance) { add_shifted(use, frame, radiance, nullptr); },
          .gradual = true,
          .slopes = [](const Use& use, const Frame& frame, std::span<const std::size_t> numbers,
                       std::span<double> columns) { shifted_slopes(use, frame, numbers, columns, nullptr); }};
}

std::vector<double> slopes_across(const Shared& shared, const Frame& frame) {
  constexpr double half = 0.5;
  Sight sight((*shared.fine)[frame.image.view], *shared.places, frame);
  const std::array<Vec2, 4> beside{Vec2{half, 0}, Vec2{-half, 0}, Vec2{0, half}, Vec2{0, -half}};
  for (const std::uint32_t p : frame.picked)
    for (const Vec2 d : beside) sight.look_at(place_of(frame.cache.pixels[p]) + d);
  sight.shade();
  std::vector<double> slopes;
  for (const std::uint32_t p : frame.picked) {
    const Pixel& pixel = frame.cache.pixels[p];
    const Rgb factor = exposure_of(frame.state, frame.image, frame.number, pixel);
    const auto seen = [&](std::size_t k) {
      return sight.at(place_of(pixel) + beside[k], p, Sight::Which::all).radiance * factor;
    };
    for (const std::size_t k : {0u, 2u}) {
      const Rgb change = seen(k) - seen(k + 1);
      slopes.insert(slopes.end(), {change.x, change.y, change.z});
    }
  }
  return slopes;
}

}  // namespace gonio::relighting
