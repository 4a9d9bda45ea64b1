// Model "chart": what a camera reads of the patches of a colour chart, in one picture or several. The base model is
//   (R, G, B) = gain A (X, Y, Z),
// A any 3 x 3 matrix, the gain of the first picture 1 and of every other one a free number. By how much printed patches
// differ from their stated colours is noise of its own, shared by all readings of a patch (chart_scatter.h).
//
// What may be left out beside the terms of sensor and lens: colour.glare, of the colour of the mean or of its own;
// sensor.black-offset, one number or one for each channel, for pictures that were balanced; light.inverse-square, light
// that falls along the chart: E = 1 / (1 + n_x dx + n_y dy)^2 about its middle, nearness n of either sign, in one over
// the unit of the places; colour.metamerism, where the table says what the sensor reads of each patch by its
// sensitivities: what of that no matrix makes of X, Y, Z. One exposure shows glare of any colour as it shows three
// offsets. Glare and offset act here before the sensor's response: on readings as dark as they matter for, that is
// linear.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "explain/tables/chart_scatter.h"
#include "explain/tables/image_views.h"
#include "explain/tables/model_parameters.h"
#include "explain/tables/table_conditions.h"
#include "explain/tables/table_model.h"
#include "light/mechanisms/light_inverse_square.h"
#include "linear/solve.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"
#include "render/mechanisms/optics_veiling_glare.h"
#include "render/mechanisms/sensor_black_offset.h"
#include "render/mechanisms/sensor_non_linearity.h"

namespace gonio::mechanism {
const Mechanism& colour_glare();
const Mechanism& colour_metamerism();
}  // namespace gonio::mechanism

namespace gonio::explain::tables {
namespace {

using Values = std::span<const double>;
constexpr std::size_t none = Table::none, fewest_patches = 12;
constexpr double least_gain = 1e-6, most_offset = 0.2, steepest = 2;
constexpr std::array<const char*, 3> channel_names = {"R", "G", "B"};
constexpr std::array<const char*, 2> along = {"x", "y"};

class Chart final : public BoundModel {
 public:
  Chart(const manifest::Document& document, const std::string& name, const Table& table) : name_(name) {
    if (table.observed.size() != 3)
      throw Error(Exit::data, table.place + "/observed", "names " + std::to_string(table.observed.size()) + " columns",
                  "model chart predicts three: what was read in R, G, B");
    read_patches(table);
    read_pictures(table);
    read_places(table);
    bind_matrix(table);
    bind_gains(table);
    read_spectra(table);
    estimate_scatter(table);
    bind_glare(table);
    bind_offset(table);
    bind_light(document.tables.at(name), table);
    bind_metamerism();
    for (const char* column : {"x", "y", "exposure_s"})
      if (std::optional<Condition> c = condition_of(table, column)) conditions_.push_back(std::move(*c));
  }

  void predict(Values values, std::size_t first, std::size_t last, std::span<double> prediction) const override {
    for (std::size_t r = first; r < last; ++r) {
      const double level = gain(values, r) * light(values, r);
      for (std::size_t c = 0; c < 3; ++c) {
        const double seen = level * (through(values, c, xyz_[r]) + spectral(values, c, r));
        const double veiled = equation::optics_veiling_glare(seen, share(values, c), mean(values, c, r));
        prediction[3 * (r - first) + c] =
            equation::sensor_black_offset(veiled, values[offset_] + values[offset_ + 1 + c]);
      }
    }
  }

  std::vector<double> scatter() const override { return scatter_; }
  std::vector<double> sigma() const override { return scatter_; }
  bool scatter_is_all() const override { return true; }
  std::string scatter_in_words() const override {
    return format(", and from patch to patch by %.2f in L* of greys and %.1f %% of colours", lightness_,
                  100 * colour_misfit_);
  }
  std::size_t blocks_a_group() const override { return by_patch_ && pictures_.size() > 1 ? 1 : 0; }

  std::string remarks(std::span<const std::string> named, Values, std::span<const double>) const override {
    const bool concerned = std::ranges::any_of(named, [](const std::string& id) {
      return id == mechanism::colour_glare().id || id == mechanism::sensor_black_offset().id ||
             id == mechanism::sensor_non_linearity().id;
    });
    if (pictures_.size() > 1 || !concerned) return {};
    return "One exposure hardly tells glare, offsets of single channels and a response that is bent by some percent "
           "apart: photograph the chart again at a quarter of it.";
  }
  void apply(Values values, std::span<const double> sigma, manifest::Document& document) const override {
    manifest::Table& section = document.tables.at(name_);
    manifest::Parameter matrix;
    std::vector<double> deviations;
    for (std::size_t k = 0; k < 9; ++k) matrix.value.push_back(values[k]), deviations.push_back(sigma[k]);
    section.parameters["camera_from_xyz"] = matrix;
    section.sigmas["camera_from_xyz"] = deviations;
    for (std::size_t k = 0; k < along.size() && light_ != none; ++k)
      if (const double v = values[light_ + k]; v != 0 || light_in_base_)
        store_parameter(section, std::string("nearness_") + along[k], v, sigma[light_ + k]);
  }
  // Light that falls along the chart is a parameter of the table: the lamp's place is in no unit of the scene. An
  // offset for each channel and a veil's colour have no place in a sensor that renders.
  bool is_of_manifest(const Candidate& candidate) const override {
    return candidate.mechanism != &mechanism::light_inverse_square();
  }

 private:
  void read_patches(const Table& table) {
    const std::vector<double>&x = table.needed("X", "1"), &y = table.needed("Y", "1"), &z = table.needed("Z", "1");
    std::map<std::array<double, 3>, std::size_t> seen;
    for (std::size_t r = 0; r < table.rows(); ++r) {
      if (!(y[r] >= 0) || y[r] > 2)
        throw Error(Exit::data, table.place, "has a row with Y " + shortest_text(y[r]),
                    "references are relative: a perfect white has Y = 1");
      xyz_.push_back({x[r], y[r], z[r]});
      patch_.push_back(seen.try_emplace({x[r], y[r], z[r]}, seen.size()).first->second);
    }
    if (seen.size() < fewest_patches)
      throw Error(Exit::data, table.place,
                  format("has %zu patches of different colour, needs %zu", seen.size(), fewest_patches),
                  "nine numbers are the camera's own: read the whole chart");
    patches_ = seen.size();
    std::vector<std::size_t> group(patches_, none);
    for (std::size_t g = 0; g < table.group.size(); ++g)
      for (std::size_t r = table.first[g]; r < table.first[g + 1]; ++r) {
        by_patch_ = by_patch_ && (group[patch_[r]] == none || group[patch_[r]] == g);
        group[patch_[r]] = g;
      }
  }

  void read_pictures(const Table& table) {
    const std::vector<double>*column = table.find("picture"), *exposure = table.find("exposure_s");
    if (column == nullptr) column = exposure;
    std::map<double, std::size_t> seen;
    for (std::size_t r = 0; r < table.rows(); ++r) {
      const auto [entry, fresh] = seen.try_emplace(column == nullptr ? 0 : (*column)[r], seen.size());
      picture_.push_back(entry->second);
      if (fresh) pictures_.push_back(std::to_string(entry->second + 1));
    }
    means_.assign(pictures_.size(), {});
    has_means_ = table.find("mean_R") != nullptr;
    for (std::size_t c = 0; c < 3 && has_means_; ++c) {
      const std::vector<double>& mean =
          table.needed(std::string("mean_") + channel_names[c], table.units[table.observed[c]]);
      for (std::size_t r = 0; r < table.rows(); ++r) means_[picture_[r]][c] = mean[r];
    }
  }

  void read_places(const Table& table) {
    for (std::size_t k = 0; k < 2; ++k) {
      const std::vector<double>* column = table.find(along[k]);
      placed_ = placed_ && column != nullptr;
      places_[k] = column == nullptr ? std::vector<double>(table.rows(), 0.0) : *column;
      const auto [least, most] = std::ranges::minmax_element(places_[k]);
      const double middle = 0.5 * (*least + *most), width = *most - *least;
      placed_ = placed_ && width > 0;
      largest_ = std::max(largest_, width);
      for (double& v : places_[k]) v -= middle;
    }
  }

  std::size_t add(const std::string& name, const std::string& unit, double start, double size) {
    Parameter p;
    p.name = name, p.unit = unit, p.start = p.neutral = start, p.size = size;
    parameters_.push_back(std::move(p));
    return parameters_.size() - 1;
  }
  std::size_t add_declared(const mechanism::Mechanism& m, std::size_t k, const std::string& on) {
    const mechanism::Parameter& d = m.parameters[k];
    const std::string prefix = m.id + "." + (on.empty() ? "" : on + "/");
    parameters_.push_back({prefix + d.name, d.unit, d.start, d.neutral, d.lower, d.upper, d.start, {}, {}});
    return parameters_.size() - 1;
  }

  // In proportion to Y, each channel by itself, to begin with.
  void bind_matrix(const Table& table) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::vector<double>& read = table.values[table.observed[c]];
      double above = 0, below = 0;
      for (std::size_t r = 0; r < table.rows(); ++r)
        if (picture_[r] == 0) above += read[r] * xyz_[r].y, below += xyz_[r].y * xyz_[r].y;
      white_[c] = above / below;
      if (!(white_[c] > 0))
        throw Error(Exit::data, table.place, std::string("reads no light in ") + table.columns[table.observed[c]],
                    "readings grow with light; name the columns that were read");
      for (const char* axis : {"X", "Y", "Z"})
        base_.push_back(add("tables/" + name_ + "/camera_from_xyz/" + channel_names[c] + axis,
                            table.units[table.observed[c]], axis[0] == 'Y' ? white_[c] : 0, white_[c]));
    }
  }
  void bind_gains(const Table& table) {
    gain_ = parameters_.size();
    std::vector<std::map<std::size_t, double>> green(pictures_.size());
    for (std::size_t r = 0; r < table.rows(); ++r) green[picture_[r]][patch_[r]] = table.values[table.observed[1]][r];
    for (std::size_t p = 1; p < pictures_.size(); ++p) {
      double above = 0, below = 0;
      for (const auto& [patch, read] : green[p])
        if (green[0].contains(patch)) above += read * green[0][patch], below += green[0][patch] * green[0][patch];
      const double ratio = below > 0 && above > 0 ? above / below : 1;
      base_.push_back(add("tables/" + name_ + "/gain/" + pictures_[p], "1", ratio, ratio));
      parameters_.back().lower = least_gain * ratio;
      parameters_.back().groups = groups_reached(table, [&](std::size_t r) { return picture_[r] == p; });
    }
  }

  // What no matrix makes of X, Y, Z, over a white's reading: the rest of the closest one, over all rows. And as much of
  // it as the readings show, which is no scatter of the print.
  void read_spectra(const Table& table) {
    if (table.find("sensed_R") == nullptr) return;
    Eigen::MatrixX3d xyz(static_cast<Eigen::Index>(table.rows()), 3), sensed = xyz, observed = xyz;
    for (int c = 0; c < 3; ++c) {
      const std::vector<double>& column = table.needed(std::string("sensed_") + channel_names[c], "1");
      for (std::size_t r = 0; r < table.rows(); ++r) {
        const auto row = static_cast<Eigen::Index>(r);
        xyz(row, c) = xyz_[r][c], sensed(row, c) = column[r];
        observed(row, c) = table.values[table.observed[c]][r] / level_of(r) / white_[c];
      }
    }
    const Eigen::Matrix3d normal = xyz.transpose() * xyz;
    const auto rest_of = [&](const Eigen::MatrixX3d& of) {
      return Eigen::MatrixX3d(of - xyz * linear::solve_ldlt(normal, Eigen::Matrix3Xd(xyz.transpose() * of)));
    };
    const Eigen::MatrixX3d rest = rest_of(sensed), left = rest_of(observed);
    for (Eigen::Index r = 0; r < rest.rows(); ++r) spectral_.push_back({rest(r, 0), rest(r, 1), rest(r, 2)});
    shown_share_ = (left.array() * rest.array()).sum() / std::max(1e-300, rest.squaredNorm());
  }
  double level_of(std::size_t row) const {
    return picture_[row] == 0 ? 1 : parameters_[gain_ + picture_[row] - 1].start;
  }
  void bind_metamerism() {
    if (spectral_.empty()) return;
    const mechanism::Mechanism& m = mechanism::colour_metamerism();
    metamerism_ = add_declared(m, 0, "");
    candidates_.push_back({&m, {}, {metamerism_}, m.id});
  }
  double spectral(Values values, std::size_t c, std::size_t row) const {
    return metamerism_ == none ? 0 : values[metamerism_] * white_[c] * spectral_[row][c];
  }

  void estimate_scatter(const Table& table) {
    std::vector<ChartPatch> all(patches_);
    std::vector<std::size_t> rows(patches_, 0);
    for (std::size_t r = 0; r < table.rows(); ++r) {
      ChartPatch& p = all[patch_[r]];
      const double level = level_of(r);
      p.xyz = xyz_[r], p.across = places_[0][r] / std::max(largest_, 1e-300);
      p.down = places_[1][r] / std::max(largest_, 1e-300);
      for (std::size_t c = 0; c < 3; ++c) {
        p.read[c] += table.values[table.observed[c]][r] / level;
        if (!spectral_.empty()) p.read[c] -= shown_share_ * white_[c] * spectral_[r][c];
      }
      ++rows[patch_[r]];
    }
    for (std::size_t p = 0; p < patches_; ++p) {
      for (double& v : all[p].read) v /= static_cast<double>(rows[p]);
      all[p].pictures = rows[p];
    }
    const ChartScatter found = chart_scatter(all);
    lightness_ = found.lightness, colour_misfit_ = colour_misfit(found);
    for (std::size_t r = 0; r < table.rows(); ++r) {
      const double level = level_of(r);
      for (const double s : found.sigma[patch_[r]]) scatter_.push_back(s * level);
    }
    for (std::size_t c = 0; c < 3; ++c) white_[c] = found.white[c];
    for (const ChartPatch& p : all) mean_xyz_ += p.xyz / static_cast<double>(patches_);
  }

  void bind_glare(const Table&) {
    const mechanism::Mechanism& m = mechanism::colour_glare();
    glare_ = parameters_.size();
    for (std::size_t k = 0; k < m.parameters.size(); ++k) add_declared(m, k, "");
    candidates_.push_back({&m, {}, {glare_}, m.id});
    candidates_.push_back({&m, {}, {glare_, glare_ + 1, glare_ + 2}, m.id, true});
  }
  // One number for all channels, which have one black level, and one for each.
  void bind_offset(const Table& table) {
    const mechanism::Mechanism& m = mechanism::sensor_black_offset();
    offset_ = parameters_.size();
    const double most = *std::ranges::max_element(white_);
    const auto adapt = [&](double white, std::size_t c) {
      Parameter& p = parameters_.back();
      p.start = 0.01 * white, p.size = 0.01 * white, p.lower = -most_offset * white, p.upper = most_offset * white;
      p.unit = table.units[table.observed[c]];
    };
    add_declared(m, 0, ""), adapt(most, 0);
    Candidate each{&m, {}, {}, m.id, true};
    for (std::size_t c = 0; c < 3; ++c) {
      each.on.emplace_back(channel_names[c]);
      each.parameters.push_back(add_declared(m, 0, channel_names[c])), adapt(white_[c], c);
    }
    candidates_.push_back({&m, {}, {offset_}, m.id});
    candidates_.push_back(std::move(each));
  }
  void bind_light(const manifest::Table& section, const Table& table) {
    if (!placed_) return;
    const mechanism::Mechanism& m = mechanism::light_inverse_square();
    light_ = parameters_.size();
    Candidate candidate{&m, {"chart"}, {}, {}};
    const std::string unit = table.units[table.place_of("x")] == "m" ? "1/m" : "1";
    for (const char* axis : along) {
      ModelParameter given = model_parameter(section, name_, std::string("nearness_") + axis, unit, 0, false);
      light_in_base_ = light_in_base_ || given.free || given.parameter.start != 0;
      Parameter& p = given.parameter;
      p.name = m.id + "." + axis + "/" + m.parameters[0].name;
      p.lower = -steepest / largest_ / 2, p.upper = -p.lower, p.size = 0.05 / largest_;
      if (!light_in_base_) p.start = 0.02 / largest_;
      if (given.free) base_.push_back(parameters_.size());
      candidate.parameters.push_back(parameters_.size());
      parameters_.push_back(std::move(p));
    }
    if (!light_in_base_) candidates_.push_back(std::move(candidate));
  }

  static double colour_misfit(const ChartScatter& found) { return 0.06 * found.colours; }
  double through(Values values, std::size_t c, Vec3 xyz) const {
    return values[3 * c] * xyz.x + values[3 * c + 1] * xyz.y + values[3 * c + 2] * xyz.z;
  }
  double gain(Values values, std::size_t row) const {
    return picture_[row] == 0 ? 1 : values[gain_ + picture_[row] - 1];
  }
  double light(Values values, std::size_t row) const {
    if (light_ == none || (values[light_] == 0 && values[light_ + 1] == 0)) return 1;
    const Vec3 axis{0, 0, 1};
    const double nearer = values[light_] * places_[0][row] + values[light_ + 1] * places_[1][row];
    return equation::light_inverse_square(equation::light_inverse_square_arm(1, axis, axis * -nearer));
  }
  double share(Values values, std::size_t c) const {
    return values[glare_] + (c == 0 ? values[glare_ + 1] : c == 2 ? values[glare_ + 2] : 0);
  }
  // Of the picture where it is known, else of the chart's patches.
  double mean(Values values, std::size_t c, std::size_t row) const {
    return has_means_ ? means_[picture_[row]][c] : gain(values, row) * through(values, c, mean_xyz_);
  }

  std::string name_;
  std::vector<Vec3> xyz_;                     // of every row
  std::vector<std::size_t> patch_, picture_;  // of every row
  std::vector<std::string> pictures_;
  std::vector<Channels> means_;  // per picture
  std::array<std::vector<double>, 2> places_;
  Channels white_{};
  std::vector<Channels> spectral_;  // of every row; empty: sensitivities or reflectances are not known
  double shown_share_ = 0;
  Vec3 mean_xyz_{};
  std::vector<double> scatter_;
  double lightness_ = 0, colour_misfit_ = 0, largest_ = 0;
  std::size_t patches_ = 0, gain_ = 0, glare_ = 0, offset_ = 0, light_ = none, metamerism_ = none;
  bool by_patch_ = true, has_means_ = false, placed_ = true, light_in_base_ = false;
};

}  // namespace

const Model& chart() {
  static const Model model{
      .name = "chart",
      .sentence = "What a camera reads of a colour chart's patches: a matrix times the reference colours.",
      .columns = {{"X", "1", "reference under D50, a perfect white having Y = 1"},
                  {"Y", "1", "reference"},
                  {"Z", "1", "reference"},
                  {"patch", "", "its name: patches are held out one by one", false},
                  {"picture", "", "each has a gain of its own; left out: pictures differ in exposure_s", false},
                  {"exposure_s", "s", "of the picture", false},
                  {"x", "", "place on the chart along its width, in any unit of length or share", false},
                  {"y", "", "place along its height, in the same unit", false},
                  {"mean_R", "", "mean of the whole picture in R; left out: of the patches", false},
                  {"mean_G", "", "in G", false},
                  {"mean_B", "", "in B", false},
                  {"sensed_R", "1", "what the sensor's sensitivities read of it in R under the light, a white giving 1",
                   false},
                  {"sensed_G", "1", "in G", false},
                  {"sensed_B", "1", "in B", false}},
      .group_noun = "colour",
      .group = "patch",
      .bind = bind_as<Chart>};
  return model;
}

}  // namespace gonio::explain::tables
