// A sample of patterns that a projector prints by light and an instrument measures from above: a simulator of its own
// cures it (cure_simulator.h). Fields of 16 x 16 pixels in an order that is drawn: gradients, wedges, checkers of three
// scales, lines, dots, pits, later layers too faint to cure, ledges. The manifest states the growth law that was fitted
// to a wedge. Design "two prints": the same twice, a map of each.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "geom/vector.h"
#include "io/raster.h"
#include "sealed/camera_chain.h"
#include "sealed/cure_simulator.h"
#include "sealed/recording.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

constexpr int side_px = 64, field_px = 16, across = side_px / field_px, layers = 6, side = side_px * cells_per_pixel;
constexpr int margin = 2 * cells_per_pixel;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

struct Law {
  double alpha = 0, beta = 1, gamma = 0;  // layers
  double threshold() const { return gamma + std::exp(-alpha / beta); }
  double height(double g) const { return g > gamma ? std::max(0.0, alpha + beta * std::log(g - gamma)) : 0; }
};

// Least squares of alpha and beta, gamma by search.
Law fitted(const Numbers& greys, const Numbers& heights) {
  Law best;
  double least = 1e300;
  for (double gamma = -0.08; gamma < 0.08; gamma += 5e-4) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
    for (std::size_t i = 0; i < greys.size(); ++i) {
      if (!(heights[i] > 0.02)) continue;
      const double x = std::log(greys[i] - gamma), y = heights[i];
      n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y, syy += y * y;
    }
    const double beta = (n * sxy - sx * sy) / (n * sxx - sx * sx), alpha = (sy - beta * sx) / n;
    const double left = syy - alpha * sy - beta * sxy;
    if (left < least) least = left, best = {alpha, beta, gamma};
  }
  return best;
}

class Prints final : public World {
 public:
  std::vector<EffectKind> effects() const override {
    const std::vector<std::string> stage{"print"};
    std::vector<EffectKind> k;
    const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)).as_drawn(); };
    add({"lamp", "print.growth", stage, {"print.grey"}, 0.12, 0.4}).of_either_sign().values = [this](const Numbers& s) {
      const double f = std::exp(s[0]), k0 = 1 / (law_.threshold() - law_.gamma);
      if (states_no_law_) return std::vector<TrueValue>{};
      // Of the law that is fitted to the wedge: nearly what the simulator has.
      return std::vector<TrueValue>{{"print.growth", "white", law_.beta * s[0] / law_.height(1), false},
                                    {"print.growth", "threshold", (1 / f - 1) / k0, false},
                                    {"print.growth", "curvature", (f - 1) * k0, false}};
    };
    add({"spread light", "print.bleed", stage, {"print.neighbours", "print.edge"}, 0.35, 0.9}).values =
        [this](const Numbers& s) {
          return std::vector<TrueValue>{{"print.bleed", "sigma_m", std::hypot(s[0], 0.08) * pixel_m_, tail_ == 0}};
        };
    add({"light through layers", "print.overcure", stage, {"print.later-light"}, 1, 1}).values =
        [this](const Numbers&) {
          return std::vector<TrueValue>{{"print.overcure", "overcure_m", cure_.penetration * layer_m_}};
        };
    add({"slipped layer", "print.layer-shift", stage, {"print.slope-x", "print.slope-y", "print.layer"}, 0.25, 1.2})
        .values = [this](const Numbers& s) {
      return std::vector<TrueValue>{{"print.layer-shift", "x_m", s[0] * std::cos(direction_) * pixel_m_},
                                    {"print.layer-shift", "y_m", s[0] * std::sin(direction_) * pixel_m_}};
    };
    add({"shrunk", "print.shrinkage", stage, {"print.size-x", "print.size-y", "print.height"}, 0.004, 0.02})
        .of_parts(3)
        .means({"x", "y", "z"});
    add({"pressed membrane", "print.membrane", stage, {"print.grey", "print.below-top"}, 0.06, 0.25}).values =
        [this](const Numbers& s) {
          return std::vector<TrueValue>{{"print.membrane", "cut_m", s[0] * layer_m_}};
        };
    add({"tilted projector", "print.pixel-tilt", stage, {"print.place-x", "print.place-y"}, 0.6, 1.6}).values =
        [this](const Numbers& s) {
          const char* names[] = {"slope_x", "slope_x", "slope_y", "slope_y"};
          const double sign = far_side_ % 2 == 0 ? 1 : -1;
          return std::vector<TrueValue>{{"print.pixel-tilt", names[far_side_], sign * s[0] / side_px}};
        };
    add({"ground", "print.ground-noise", stage, {}, 0.03, 0.1}).only_for("two prints").values =
        [this](const Numbers& s) {
          return std::vector<TrueValue>{
              {"print.ground-noise", "rms_m", s[0] * layer_m_},
              {"print.ground-noise", "length_m", std::sqrt(2.0) * ground_px_ * pixel_m_, true, false}};
        };
    add({"rough", "", stage, {}, 0.03, 0.1});
    add({"oxygen from the sides", "", stage, {}, 0.15, 0.5});
    add({"scratched membrane", "", stage, {}, 0.06, 0.25});
    add({"cooling resin", "", stage, {}, 0.03, 0.1});
    return k;
  }

  void design(Random& random, const std::string& variant) override {
    states_no_law_ = variant == "no law";
    prints_ = variant == "two prints" ? 2 : 1;
    pixel_m_ = random.uniform(20e-6, 45e-6), layer_m_ = random.uniform(15e-6, 30e-6);
    cure_.side_px = side_px, cure_.layers = layers;
    cure_.penetration = random.uniform(0.45, 0.7), cure_.leak = random.uniform(0.002, 0.02);
    cure_.white = random.uniform(0.93, 0.985), cure_.oxygen = random.uniform(0.1, 0.5);
    tail_ = random.uniform() < 0.5 ? 0 : random.uniform(0.05, 0.2);
    tail_px_ = random.uniform(1.5, 3), direction_ = random.uniform(0, 2 * pi);
    slips_at_ = 4 + static_cast<int>(random.below(2)), far_side_ = static_cast<int>(random.below(4));
    scratch_angle_ = random.uniform(0, pi), scratch_at_ = random.uniform(0.3, 0.7);
    noise_m_ = random.uniform(0.015, 0.035) * layer_m_;
    blur_px_ = random.uniform(0.15, 0.3);
    slope_x_ = random.uniform(-2e-3, 2e-3), slope_y_ = random.uniform(-2e-3, 2e-3);
    offset_m_ = random.uniform(-1, 1) * layer_m_;
    misplaced_px_[0] = 0.1 * random.normal(), misplaced_px_[1] = 0.1 * random.normal();
    ground_seed_ = random.next();
    Numbers greys;
    for (int k = 0; k <= 50; ++k) greys.push_back(k / 50.0);
    law_ = fitted(greys, wedge(cure_, greys));
    draw_pictures(random);
    ground_px_ = prints_ > 1 ? random.uniform(1.2, 2.5) : 1.6;
  }

  Numbers base() const override { return {0}; }
  Numbers base_steps() const override { return {1}; }
  std::vector<Numbers> base_columns() const override {  // a plane, and where the map lies
    const Numbers z = simulate({}, {});
    std::vector<Numbers> columns(5 * prints_, Numbers(z.size(), 0.0));
    for (std::size_t p = 0; p < prints_; ++p)
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          const std::size_t i = cell(p, x, y);
          Numbers* own = &columns[5 * p];
          own[0][i] = 1e-6, own[1][i] = 1e-6 * (x - side / 2) / side, own[2][i] = 1e-6 * (y - side / 2) / side;
          if (x > 0 && x + 1 < side) own[3][i] = z[i + 1] - z[i - 1];
          if (y > 0 && y + 1 < side) own[4][i] = z[i + side] - z[i - side];
        }
    return columns;
  }

  Numbers simulate(const Numbers&, const Sizes& sizes) const override {
    for (const auto& [known, heights] : simulated_)
      if (known == sizes) return heights;
    Numbers z = cured(with(sizes), pictures_);
    for (double& v : z) v *= layer_m_;
    if (sizes.contains("shrunk"))
      z = shrunk(z, size_of(sizes, "shrunk", 0), size_of(sizes, "shrunk", 1), size_of(sizes, "shrunk", 2));
    const double rough = std::max(size_of(sizes, "rough"), size_of(sizes, "ground"));
    Numbers all;
    for (std::size_t p = 0; p < prints_; ++p) {
      Numbers own = z;
      if (rough > 0) roughen(own, rough * layer_m_, p);
      const Numbers map = seen(own);
      all.insert(all.end(), map.begin(), map.end());
    }
    simulated_.emplace_back(sizes, std::move(all));
    return simulated_.back().second;
  }
  Numbers sigma(const Numbers& clean) const override { return Numbers(clean.size(), noise_m_); }
  Numbers noisy(const Numbers& clean, Random& random) const override {
    Numbers z = clean;
    for (double& v : z) v += noise_m_ * random.normal();
    missing_.assign(z.size(), 0);
    for (std::size_t p = 0; p < prints_; ++p)
      for (int y = 1; y + 1 < side; ++y)  // steep walls throw the light aside
        for (int x = 1; x + 1 < side; ++x) {
          const std::size_t i = cell(p, x, y);
          const double steep = std::hypot(clean[i + 1] - clean[i - 1], clean[i + side] - clean[i - side]) /
                               (2 * pixel_m_ / cells_per_pixel);
          missing_[i] = random.uniform() < (steep > 1.2 ? 0.7 : 0.003);
        }
    return z;
  }
  Numbers norm(const Numbers& observed) const override { return Numbers(observed.size(), 1e-12); }
  bool relative() const override { return false; }
  bool asks_rivals() const override { return false; }
  bool knows_floor() const override { return false; }  // scored by means over pixels
  void locate(const Numbers&, const Numbers&, Case&) const override {}

  void write(const Numbers& observed, const Numbers&, Case& into) const override {
    const int kept = side - 2 * margin;
    const double step_m = pixel_m_ / cells_per_pixel;
    for (std::size_t p = 0; p < prints_; ++p) {
      Numbers z;  // rows from the top: from the largest y
      for (int y = kept - 1; y >= 0; --y)
        for (int x = 0; x < kept; ++x) {
          const std::size_t i = cell(p, x + margin, y + margin);
          z.push_back(missing_[i] ? none : observed[i] + offset_m_ + slope_x_ * step_m * x + slope_y_ * step_m * y);
        }
      into.files[file_of(p) + ".sur"] = profile(kept, kept, step_m, z);
    }
    for (std::size_t k = 0; k < pictures_.size(); ++k) {
      io::Image image(side_px, side_px, {"Y"});
      for (std::size_t i = 0; i < pictures_[k].size(); ++i) image.data[i] = static_cast<float>(pictures_[k][i]);
      into.files[format("layer%04zu.png", k + 1)] = io::encode_raster_png(image);
    }
    Value m = Value::object();
    for (std::size_t p = 0; p < prints_; ++p)
      m["reliefs"][p == 0 ? "sample" : "second"] = Value::object({{"file", file_of(p)}});
    Value print = Value::object({{"width_px", side_px}, {"height_px", side_px}, {"layer_m", layer_m_}});
    print["pixel_m"] = Value(std::vector<double>{pixel_m_, pixel_m_});
    print["layers"] = "layer0001";
    if (!states_no_law_)
      print["growth"] =
          Value::object({{"alpha_m", law_.alpha * layer_m_}, {"beta_m", law_.beta * layer_m_}, {"gamma", law_.gamma}});
    const double first = -0.5 * side_px * pixel_m_ + (margin + 0.5) * step_m;
    print["measured"] = Value::array();
    for (std::size_t p = 0; p < prints_; ++p) {
      Value map = Value::object({{"relief", p == 0 ? "sample" : "second"}});
      map["at_m"] =
          Value(std::vector<double>{first + misplaced_px_[0] * pixel_m_, -first + misplaced_px_[1] * pixel_m_});
      print["measured"].as_array().push_back(map);
    }
    m["prints"]["p"] = print;
    finish(m, into);
  }

 private:
  static std::size_t cell(std::size_t print, int x, int y) {
    return print * side * side + static_cast<std::size_t>(y * side + x);
  }
  static std::string file_of(std::size_t print) { return print == 0 ? "map" : "map2"; }
  Cure with(const Sizes& sizes) const {
    Cure c = cure_;
    c.lamp = std::exp(size_of(sizes, "lamp"));
    if (const double core = size_of(sizes, "spread light"); core > 0)
      c.core_px = core, c.tail_share = tail_, c.tail_px = tail_px_;
    c.stays = sizes.contains("light through layers");
    if (const double slip = size_of(sizes, "slipped layer"); slip > 0)
      c.shifted_from = slips_at_, c.shift_x_px = slip * std::cos(direction_),
      c.shift_y_px = slip * std::sin(direction_);
    c.bulge = size_of(sizes, "pressed membrane");
    c.defocus_px = size_of(sizes, "tilted projector"), c.defocus_side = far_side_;
    c.side_oxygen = size_of(sizes, "oxygen from the sides");
    c.scratch = size_of(sizes, "scratched membrane");
    c.scratch_angle = scratch_angle_, c.scratch_at = scratch_at_;
    c.drift = size_of(sizes, "cooling resin");
    return c;
  }

  // Layers 1 and 2 are white everywhere. A field's patterns from layer 3 on; `faint` does not cure by itself.
  void draw_pictures(Random& random) {
    std::array<int, across * across> order{};
    for (int k = 0; k < across * across; ++k) order[static_cast<std::size_t>(k)] = k;
    for (std::size_t k = order.size(); k > 1; --k)
      std::swap(order[k - 1], order[random.below(static_cast<std::uint32_t>(k))]);
    const double faint = 0.75 * std::max(0.0, law_.threshold());
    std::array<double, 16> step{};
    for (std::size_t k = 0; k < step.size(); ++k) step[k] = (static_cast<double>(k) + random.uniform(0.3, 0.9)) / 16;
    for (std::size_t k = step.size(); k > 1; --k)
      std::swap(step[k - 1], step[random.below(static_cast<std::uint32_t>(k))]);
    pictures_.assign(layers, Greys(side_px * side_px, 1.0));
    for (int y = 0; y < side_px; ++y)
      for (int x = 0; x < side_px; ++x) {
        const int field = order[static_cast<std::size_t>(y / field_px * across + x / field_px)];
        const auto stack = column(field, x % field_px, y % field_px, faint, step);
        for (std::size_t k = 0; k < stack.size(); ++k)
          pictures_[k + 2][static_cast<std::size_t>(y * side_px + x)] = std::round(255 * stack[k]) / 255;
      }
  }
  static std::array<double, 4> column(int field, int x, int y, double faint, const std::array<double, 16>& step) {
    const double along_x = (x + 0.5) / field_px, along_y = (y + 0.5) / field_px;
    const double patch = step[static_cast<std::size_t>(y / 4 * 4 + x / 4)];
    const auto checker = [&](int scale, double dark, double bright) {
      return (x / scale + y / scale) % 2 == 0 ? dark : bright;
    };
    switch (field) {
      case 0: return {along_x, 0, 0, 0};
      case 1: return {1, along_y, 0, 0};
      case 2: return {1, 1, patch, 0};
      case 3: return {1, 1, 1, patch};
      case 4: return {1, checker(1, 0.35, 0.95), 0, 0};
      case 5: return {1, 1, checker(2, 0.3, 0.9), 0};
      case 6: return {1, 1, 1, checker(4, 0.25, 1)};
      case 7: return {checker(2, 0.4, 1), 0, 0, 0};
      case 8: return {1, 1, 1, x / 2 % 2 == 0 ? 0.3 : 0.9};
      case 9: return {1, x % 4 < 2 && y % 4 < 2 ? 0.9 : 0.0, 0, 0};
      case 10: return {1, 1, x % 4 < 2 && y % 4 < 2 ? 0.3 : 1.0, 0};
      case 11: return {patch, faint, faint, faint};
      case 12: return {along_y, faint, 0.5 * faint, 0};
      case 13: return {1, patch, faint, faint};
      case 14: return {x < 8 ? 1.0 : 0.0, x < 8 ? 1.0 : 0.0, 1, y < 8 ? 1.0 : 0.5};
      default: return {1, y < 8 ? 1.0 : 0.5, x < 8 ? 1.0 : 0.0, 0};
    }
  }

  void roughen(Numbers& z, double rms_m, std::size_t print) const {
    Random random(ground_seed_, 5 + print);
    std::vector<double> field(z.size());
    for (double& v : field) v = random.normal();
    smoothed(field, side, ground_px_ * cells_per_pixel);
    double squares = 0;
    for (const double v : field) squares += v * v;
    const double scale = rms_m / std::sqrt(squares / static_cast<double>(field.size()));
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += scale * field[i];
  }
  static Numbers shrunk(const Numbers& z, double by_x, double by_y, double by_z) {
    Numbers result(z.size());
    const double middle = 0.5 * (side - 1);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double u = std::clamp(middle + (x - middle) / (1 - by_x), 0.0, side - 1.001),
                     v = std::clamp(middle + (y - middle) / (1 - by_y), 0.0, side - 1.001);
        const int i = static_cast<int>(u), j = static_cast<int>(v);
        const double fx = u - i, fy = v - j;
        const double* at = &z[static_cast<std::size_t>(j * side + i)];
        result[static_cast<std::size_t>(y * side + x)] =
            (1 - by_z) * ((1 - fy) * ((1 - fx) * at[0] + fx * at[1]) + fy * ((1 - fx) * at[side] + fx * at[side + 1]));
      }
    return result;
  }
  // The instrument's lateral resolution, over the part alone: what lies outside is as high as its rim.
  Numbers seen(const Numbers& z) const {
    Numbers result = z, inside(z.size(), 1.0);
    smoothed(result, side, blur_px_ * cells_per_pixel);
    smoothed(inside, side, blur_px_ * cells_per_pixel);
    for (std::size_t i = 0; i < z.size(); ++i) result[i] /= inside[i];
    return result;
  }

  Cure cure_;
  Law law_;
  std::vector<Greys> pictures_;
  double pixel_m_ = 0, layer_m_ = 0, noise_m_ = 0, blur_px_ = 0, slope_x_ = 0, slope_y_ = 0, offset_m_ = 0;
  double tail_ = 0, tail_px_ = 1, direction_ = 0, scratch_angle_ = 0, scratch_at_ = 0;
  std::array<double, 2> misplaced_px_{};
  int slips_at_ = 4, far_side_ = 0;
  bool states_no_law_ = false;
  std::size_t prints_ = 1;
  double ground_px_ = 1.6;
  std::uint64_t ground_seed_ = 0;
  mutable std::vector<std::pair<Sizes, Numbers>> simulated_;
  mutable std::vector<char> missing_;  // of what noisy() saw
};

}  // namespace

std::unique_ptr<World> prints_world() {
  return std::make_unique<Prints>();
}

}  // namespace gonio::sealed
