// See polarization_problem.h.
#include "explain/polarization/polarization_problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "explain/polarization/known_light.h"
#include "explain/polarization/mosaic_input.h"
#include "explain/polarization/mosaic_light.h"
#include "explain/polarization/polarization_outcome.h"
#include "explain/polarization/polarization_term.h"
#include "inference/explanation.h"
#include "photograph/polarizers.h"
#include "relighting/cells.h"
#include "render/mechanisms/optics_veiling_glare.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

using namespace polarization;

constexpr double steepest = 0.2, exposure_sigma = 0.01;
constexpr std::size_t least_groups = 8, least_tiles = 4, fewest_rows = 400;
constexpr double infinity = std::numeric_limits<double>::infinity();

class PolarizationProblem final : public Problem {
 public:
  PolarizationProblem(const manifest::Document& document, const ProblemOptions& options, const std::string& camera,
                      KnownLight* known)
      : light_(document, options.repeats, camera, known),
        array_(array_in_use(document, camera)),
        veil_(veil_in_use(document, camera)),
        film_(films_in_use(document, light_.setup())) {
    find_means();
    group_tiles();
    choose_rows();
    if (rows_.size() < fewest_rows) refuse_few(document, camera, rows_.size());
    observe();
    exposures();
    for (const Term* term : all_terms())
      if (!is_in_use(document, term->mechanism(), camera)) enter(*term);
    observations_.conditions = mosaic_conditions(light_, rows_, state_of(neutral()), gain_, mean_);
  }

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    const State state = state_of(values);
    std::vector<double> reading;
    std::size_t tile = Tiles::none;
    for (std::size_t i = observations_.first[group]; i < observations_.first[group + 1]; ++i) {
      const Row& row = rows_[i];
      if (row.tile != tile) light_.readings(row.tile, state, reading), tile = row.tile;
      prediction[i - observations_.first[group]] = exposure(values, row) * reading[row.place] + veil(state, row);
    }
  }

  std::string domain() const override { return "polarization"; }
  std::string unit() const override { return "1"; }
  std::string score_name() const override { return "relative RMSE"; }
  std::string group_noun() const override { return cells_ > 1 ? "cell" : "image"; }
  Importance importance() const override { return Importance::share_of_signal; }
  bool outliers_are_effects() const override { return true; }
  double fit_tolerance() const override { return 1e-7; }

  std::string remarks(const Explanation&) const override {
    return format("%zu samples in %zu tiles of %zu pictures were held against the simulation.", rows_.size(),
                  light_.tiles().size(), light_.recordings().images.size());
  }
  void apply(const Explanation& e, manifest::Document& document) const override {
    for (const Use& use : uses_) upgrade(light_.setup(), use, e, document);
    for (std::size_t g = 0; g < light_.recordings().images.size(); ++g)
      write_gain(document, light_.recordings().images[g].entry, e.values[exposure_] * e.values[own_exposure_ + g]);
  }
  Illustration illustrate(const Explanation& e, const std::filesystem::path&, manifest::Document&) const override {
    return illustrate_mosaics(light_, rows_, observations_, e);
  }

 private:
  struct Tiles {
    static constexpr std::size_t none = static_cast<std::size_t>(-1);
  };

  double exposure(std::span<const double> values, const Row& row) const {
    const std::size_t image = light_.tiles()[row.tile].image;
    return light_.recordings().images[image].gain.value.at(0) * values[exposure_] * values[own_exposure_ + image];
  }
  // In units of the recordings. Their means have the veil in them.
  double veil(const State& state, const Row& row) const {
    const Site& site = light_.site(row.tile, row.place);
    const double mean = mean_[light_.tiles()[row.tile].image][polarizer_over(site.x, site.y)];
    return equation::optics_veiling_glare(0, state.veil, mean / (1 + state.veil));
  }
  void find_means() {
    for (const relighting::Recording& image : light_.recordings().images) {
      PolarizerMeans sum{}, count{};
      for (int y = 0; y < image.picture.height; ++y)
        for (int x = 0; x < image.picture.width; ++x)
          sum[polarizer_over(x, y)] += image.picture.at(x, y, 0), ++count[polarizer_over(x, y)];
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] /= std::max(1.0, count[k]);
      mean_.push_back(sum);
    }
  }
  State stated() const {
    State state;
    state.veil = veil_;
    state.array = array_;
    state.rougher.assign(light_.setup().rough.size(), 0.0);
    state.film = film_;
    return state;
  }
  State state_of(std::span<const double> values) const {
    State state = stated();
    for (const Use& use : uses_) {
      const std::span<const double> p = values.subspan(use.first, use.neutral.size());
      if (!std::ranges::equal(p, use.neutral)) use.term->set(state, use.form, p);
    }
    return state;
  }
  std::vector<double> neutral() const {
    std::vector<double> values;
    for (const Parameter& p : parameters_) values.push_back(p.neutral);
    return values;
  }

  // Tiles of a picture, cell by cell.
  void group_tiles() {
    const std::size_t images = light_.recordings().images.size();
    cells_ = relighting::cells_each(images, least_groups);
    for (std::size_t g = 0; g < images; ++g) {
      std::vector<std::size_t> mine;
      std::vector<std::array<int, 2>> places;
      for (std::size_t t = 0; t < light_.tiles().size(); ++t)
        if (light_.tiles()[t].image == g)
          mine.push_back(t), places.push_back({light_.tiles()[t].x, light_.tiles()[t].y});
      const auto parts = relighting::cells_of(places, cells_, least_tiles);
      const std::string& id = light_.recordings().images[g].id;
      for (std::size_t k = 0; k < parts.size(); ++k) {
        std::vector<std::size_t>& tiles = tiles_of_group_.emplace_back();
        for (const std::size_t p : parts[k]) tiles.push_back(mine[p]);
        observations_.group.push_back(parts.size() > 1 ? id + format(", part %zu", k + 1) : id);
        image_of_group_.push_back(g);
      }
    }
  }

  bool is_even(std::size_t tile, std::size_t place) const {
    const double here = light_.site(tile, place).stokes[0];
    for (const std::size_t beside : {place - 1, place + 1, place - side_px, place + side_px})
      if (!(std::abs(light_.site(tile, beside).stokes[0] - here) < steepest * here)) return false;
    return true;
  }
  void choose_rows() {
    std::size_t g = 0;
    std::vector<std::string> names;
    for (std::size_t n = 0; n < tiles_of_group_.size(); ++n) {
      const std::size_t first = rows_.size();
      for (const std::size_t tile : tiles_of_group_[n])
        for (const int degrees : {0, 45, 90, 135})
          for (std::size_t y = 1; y + 1 < side_px; ++y)
            for (std::size_t x = 1; x + 1 < side_px; ++x) {
              const std::size_t place = y * side_px + x;
              const Site& site = light_.site(tile, place);
              if (photograph::polarizer_degrees(site.x, site.y) == degrees && is_even(tile, place))
                rows_.push_back({tile, place});
            }
      if (rows_.size() == first) continue;
      observations_.first.push_back(first);
      names.push_back(observations_.group[n]), image_of_group_[g++] = image_of_group_[n];
    }
    observations_.first.push_back(rows_.size());
    observations_.group = names;
    image_of_group_.resize(g);
  }

  // Mean of the samples behind the same polarizer around: a brightness that the sample's own noise hardly moves.
  static double level(const relighting::Recording& image, int x, int y) {
    double sum = 0, count = 0;
    for (const auto& [u, v] : {std::array{0, 0}, {-2, 0}, {2, 0}, {0, -2}, {0, 2}}) {
      if (x + u < 0 || y + v < 0 || x + u >= image.picture.width || y + v >= image.picture.height) continue;
      if (!image.counts[static_cast<std::size_t>((y + v) * image.picture.width + x + u)]) continue;
      sum += image.picture.at(x + u, y + v, 0), count += 1;
    }
    return count > 0 ? sum / count : image.picture.at(x, y, 0);
  }
  void observe() {
    Observations& o = observations_;
    const State state = stated();
    std::vector<double> reading, simulated, ratio;
    std::size_t tile = Tiles::none;
    for (const Row& row : rows_) {
      if (row.tile != tile) light_.readings(row.tile, state, reading), tile = row.tile;
      simulated.push_back(reading[row.place]);
      const Site& site = light_.site(row.tile, row.place);
      const relighting::Recording& image = light_.recordings().images[light_.tiles()[row.tile].image];
      const double y = image.picture.at(site.x, site.y, 0);
      o.value.push_back(y), o.norm.push_back(y * y), o.block.push_back(static_cast<std::uint32_t>(row.tile));
      if (simulated.back() > 0) ratio.push_back((y - veil(state, row)) / (image.gain.value.at(0) * simulated.back()));
    }
    gain_ = ratio.empty() ? 1 : stats::median(ratio);
    renumber_blocks();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Site& site = light_.site(rows_[i].tile, rows_[i].place);
      const relighting::Recording& image = light_.recordings().images[light_.tiles()[rows_[i].tile].image];
      const auto place = 3 * static_cast<std::size_t>(site.y * image.picture.width + site.x);
      const double noise = relighting::noise_sigma(image, level(image, site.x, site.y), place);
      const double passed = site.stokes[0] > 0 ? simulated[i] / site.stokes[0] : 0;
      o.sigma.push_back(std::hypot(noise, gain_ * image.gain.value.at(0) * passed * std::sqrt(site.variance)));
    }
  }
  void renumber_blocks() {
    std::uint32_t blocks = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (i > 0 && rows_[i].tile != rows_[i - 1].tile) ++blocks;
      observations_.block[i] = blocks;
    }
  }

  std::size_t add(Parameter p) {
    parameters_.push_back(std::move(p));
    return parameters_.size() - 1;
  }
  void exposures() {
    const std::string prefix = "polarization/" + light_.setup().camera + "/";
    exposure_ = add({prefix + "exposure", "1", gain_, gain_, 0, infinity, 0.01 * gain_, {}, {}});
    base_.push_back(exposure_);
    own_exposure_ = parameters_.size();
    for (std::size_t g = 0; g < light_.recordings().images.size(); ++g) {
      std::vector<std::size_t> groups;
      for (std::size_t k = 0; k < image_of_group_.size(); ++k)
        if (image_of_group_[k] == g) groups.push_back(k);
      const bool seen = !groups.empty();
      const std::string& id = light_.recordings().images[g].id;
      const std::size_t p =
          add({prefix + id + "/exposure", "1", 1, 1, 0, infinity, exposure_sigma, exposure_sigma, std::move(groups)});
      if (seen) base_.push_back(p);
    }
  }

  void enter(const Term& term) {
    const mechanism::Mechanism& m = term.mechanism();
    const std::vector<Form> forms = term.forms(light_.setup());
    for (const Form& form : forms) {
      Use use{&term, form, parameters_.size(), {}};
      Candidate candidate{&m, {}, {}, {}, form.finer};
      if (forms.size() > 1 && form.on.empty()) candidate.family = m.id;
      if (!form.on.empty()) candidate.on = {form.on};
      const std::string of = form.on.empty() ? "" : form.on + ".";
      for (const mechanism::Parameter& info : m.parameters) {
        const bool fitted = std::ranges::find(form.parameters, info.name) != form.parameters.end();
        const double start = form.side < 0 ? 2 * info.neutral - info.start : info.start;
        Parameter p;
        p.name = m.id + "." + of + info.name, p.unit = info.unit;
        p.start = start, p.neutral = info.neutral;
        p.lower = form.side > 0 ? info.neutral : info.lower, p.upper = form.side < 0 ? info.neutral : info.upper;
        if (form.upper > 0 && fitted) p.upper = form.upper;
        p.size = std::max(std::abs(start - info.neutral), 1e-3);
        if (fitted) candidate.parameters.push_back(parameters_.size());
        use.neutral.push_back(info.neutral);
        add(std::move(p));
      }
      candidates_.push_back(std::move(candidate));
      uses_.push_back(std::move(use));
    }
  }

  MosaicLight light_;
  photograph::PolarizerArray array_;  // as the manifest has it
  double veil_ = 0;                   // likewise
  std::vector<Film> film_;            // likewise
  std::vector<PolarizerMeans> mean_;  // of each picture's samples
  std::size_t cells_ = 1;
  std::vector<std::vector<std::size_t>> tiles_of_group_;
  std::vector<std::size_t> image_of_group_;
  std::vector<Row> rows_;
  std::vector<Use> uses_;
  double gain_ = 1;
  std::size_t exposure_ = 0, own_exposure_ = 0;
};

std::vector<std::unique_ptr<Problem>> problems_of(const manifest::Document& document, const ProblemOptions& options,
                                                  KnownLight* known) {
  std::vector<std::unique_ptr<Problem>> problems;
  for (const std::string& camera : mosaic_cameras(document))
    problems.push_back(std::make_unique<PolarizationProblem>(document, options, camera, known));
  return problems;
}

}  // namespace

std::vector<std::unique_ptr<Problem>> polarization_problems(const manifest::Document& document,
                                                            const ProblemOptions& options) {
  return problems_of(document, options, nullptr);
}

std::vector<std::unique_ptr<Problem>> polarization_problems(const manifest::Document& document,
                                                            const ProblemOptions& options, KnownLight& known) {
  return problems_of(document, options, &known);
}

}  // namespace gonio::explain
