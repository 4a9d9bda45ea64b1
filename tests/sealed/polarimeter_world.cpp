// A polarimeter: a polarizer, a plate that is turned, a mirror, an analyser; fields of two incoherent waves are
// followed through, in eleven lines of a lamp.
#include <array>
#include <cmath>

#include "sealed/coherent_light.h"
#include "sealed/rows_world.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

constexpr std::size_t lines = 11;
using Wave = std::array<Complex, 2>;  // along x, the mirror's s axis, and y

// What an element does along its axis at `angle`, and across it.
Wave through(const Wave& e, double angle, Complex along, Complex across) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Complex a = (c * e[0] + s * e[1]) * along, b = (c * e[1] - s * e[0]) * across;
  return {c * a - s * b, s * a + c * b};
}

class Polarimeter final : public RowsWorld {
 public:
  std::vector<EffectKind> effects() const override {
    std::vector<EffectKind> k;
    const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
    const std::vector<std::string> angles{"polarimeter.analyser", "polarimeter.retarder"},
        colour{"light.wavelength", "polarimeter.retarder"};
    add({"leaky sheets", "polarizer.leak", {"sensor"}, angles, 0.004, 0.05}).means({"leak"});
    add({"turned analyser", "polarizer.angle", {"sensor"}, angles, 0.006, 0.05}).of_either_sign().means({"turn_rad"});
    add({"plain plate", "retarder.dispersion", {"optics"}, colour, 0.02, 0.2}).as_drawn().values =
        [](const Numbers& s) {
          return std::vector<TrueValue>{{"retarder.dispersion", "order", 1 + 2 * s[0], false}};
        };
    add({"coated mirror", "surface.coating", {"surface"}, colour, 15e-9, 90e-9}).as_drawn().values =
        [this](const Numbers& s) {
          return std::vector<TrueValue>{{"surface.coating", "film_m", s[0]},
                                        {"surface.coating", "film_eta", film_index_, true, false}};
        };
    add({"milky mirror", "", {}, {}, 0.03, 0.12});
    add({"wedged plate", "", {}, {}, 0.04, 0.15});
    return k;
  }
  void design(Random& random, const std::string&) override {
    for (const char* name : {"polarizer", "retarder", "analyser", "retardance", "theta_i"}) add_column(name, "rad");
    add_column("wavelength_m", "m"), add_column("mirror_n", "1"), add_column("mirror_k", "1");
    add_column("design_m", "m");
    film_index_ = random.uniform(1.33, 1.6);
    const double theta = random.uniform(0.9, 1.2), n = random.uniform(1.4, 2.8), k = random.uniform(0, 3);
    const double late = pi / 2 * random.uniform(0.9, 1.1);
    relative_ = random.uniform(0.002, 0.005);
    for (double& g : gain_) g = random.uniform(0.4, 1);
    for (int turn = 0; turn < 12; ++turn)
      for (const double analyser : {0.3, 0.3 + pi / 4, 0.3 + pi / 2})
        for (std::size_t line = 0; line < lines; ++line)
          add_row({pi / 4, turn * pi / 12, analyser, late, theta, wavelength(line), n, k, 550e-9});
  }
  Numbers base() const override { return Numbers(gain_.begin(), gain_.end()); }
  Numbers base_steps() const override { return Numbers(lines, 1e-3); }

 protected:
  double reading(const Numbers& base, const Sizes& sizes, std::size_t r) const override {
    const double leak = std::sqrt(size_of(sizes, "leaky sheets")), length = at("wavelength_m", r);
    const double over = at("design_m", r) / length, bend = size_of(sizes, "plain plate");
    double late = at("retardance", r);
    if (bend > 0) late *= over * (1 + bend * (over * over - 1));
    late *= 1 + size_of(sizes, "wedged plate") * std::cos(at("retarder", r));
    Mirror mirror;
    mirror.index = {at("mirror_n", r), at("mirror_k", r)};
    mirror.film_m = size_of(sizes, "coated mirror"), mirror.film_index = film_index_;
    const Pair p = amplitudes(std::cos(at("theta_i", r)), mirror, length);
    double total = 0, lost = 0;
    for (const Wave& sent : {Wave{std::sqrt(0.5), 0}, Wave{0, std::sqrt(0.5)}}) {
      Wave e = through(sent, at("polarizer", r), 1, leak);
      e = through(e, at("retarder", r), std::polar(1.0, late), 1);
      e = through(e, 0, p.s, p.p);
      lost += 0.5 * (std::norm(e[0]) + std::norm(e[1]));
      e = through(e, at("analyser", r) + size_of(sizes, "turned analyser"), 1, leak);
      total += std::norm(e[0]) + std::norm(e[1]);
    }
    const double milk = size_of(sizes, "milky mirror");
    return base[line_of(length)] * ((1 - milk) * total + milk * lost);
  }
  double noise_of(double v) const override { return std::hypot(relative_ * v, 4e-4); }
  std::string model() const override { return "polarimeter"; }
  void describe(Value&, Value& table) const override { table["group"] = "retarder"; }

 private:
  static double wavelength(std::size_t line) { return 450e-9 + 20e-9 * static_cast<double>(line); }
  static std::size_t line_of(double length) { return static_cast<std::size_t>(std::lround((length - 450e-9) / 20e-9)); }

  std::array<double, lines> gain_{};
  double film_index_ = 1.38, relative_ = 0.003;
};

}  // namespace

std::unique_ptr<World> polarimeter_world() {
  return std::make_unique<Polarimeter>();
}

}  // namespace gonio::sealed
