// See volumes_problem.h.
#include "explain/volumes/volumes_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "explain/volumes/volume_term.h"
#include "explain/volumes/volumes_outcome.h"
#include "inference/explanation.h"
#include "volume/spectrum.h"

namespace gonio::explain {
namespace {

using namespace volumes;

// Edges of a tomograph that resolves its voxels, sd in voxels; what its linear interpolation adds is in it.
// Readings are logarithms of intensities that a pixel averages over its area, so that they fall short where the path
// changes within a pixel, the more the larger the wall's radius of curvature: walls stand some hundredths of a voxel
// too far in (Glover & Pelc, Medical Physics 7 (1980) 238-248). No tomograph is free of it; what it does to a wall of
// any radius, and to one of thirty voxels beside that, is free within these bounds: what pixels do that are voxels was
// simulated.
constexpr double usual_bias = 0.015, largest_bias = 0.03, usual_radius = 30, least_radius = 4, largest_radius = 120;
// A blur of less than half a voxel is no blur: no simulation knows the pixels' own shape so well.
constexpr double own_variance = 0.16, usual_own_variance = 0.06;
constexpr double sharper = 0.1;  // than simulated a tomograph may be whose pixels are smaller than its voxels
constexpr double largest_variance = 3, variance_sigma = 0.5;
constexpr double value_sigma = 0.3;  // no reading may be deep enough to tell
constexpr double ideal_sigma = 0.15, narrowest = 0.25, widest = 0.8;

class VolumesProblem final : public Problem {
 public:
  explicit VolumesProblem(VolumesInput input) : input_(std::move(input)), observed_(volumes::observed(input_)) {
    input_.volume.values = {};
    base_parameters();
    for (const Term* term : all_terms()) enter(*term);
    std::ranges::stable_sort(uses_, {}, [](const Use& u) { return u.term->order; });
    observe();
  }

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    const std::size_t first = observations_.first[group];
    std::vector<std::vector<double>> parameters;
    std::vector<const Use*> active;
    for (const Use& use : uses_) {
      std::vector<double> p(values.begin() + static_cast<std::ptrdiff_t>(use.first),
                            values.begin() + static_cast<std::ptrdiff_t>(use.first + use.neutral.size()));
      if (p == use.neutral) continue;
      if (use.term->of_spectrum) p.push_back(values[Base::spectrum]);
      active.push_back(&use);
      parameters.push_back(std::move(p));
    }
    for (std::size_t i = 0; i < prediction.size(); ++i) {
      const Row& row = observed_.rows[first + i];
      double v = base_value(row, values);
      for (std::size_t u = 0; u < active.size(); ++u) v = active[u]->term->act(v, row, observed_, parameters[u]);
      prediction[i] = v * weight_of(row);
    }
  }

  std::string domain() const override { return "volumes"; }
  std::string unit() const override { return "voxel"; }
  std::string score_name() const override { return "RMS error of walls, edges and grey values"; }
  std::string group_noun() const override { return "block of space"; }
  Importance importance() const override { return Importance::share_of_residual; }

  std::string remarks(const Explanation& e) const override { return volumes_remarks(input_, observed_, *this, e); }
  void apply(const Explanation& e, manifest::Document& document) const override {
    upgrade_volumes(input_, *this, e, document);
  }
  Illustration illustrate(const Explanation& e, const std::filesystem::path&, manifest::Document&) const override {
    return illustrate_volumes(observed_, e);
  }

 private:
  struct Use {
    const Term* term = nullptr;
    std::size_t first = 0;
    std::vector<double> neutral;
  };
  struct Base {
    enum : std::size_t {
      shift = 0,
      turn = 3,
      air = 6,
      material,
      width_within,
      width_across,
      width_between,
      width_by_curvature,
      bias,
      bias_by_radius,
      own_blur,
      spectrum
    };
  };

  // What a wider edge than the simulated one does to walls and grey values: as a slight blur.
  double widened(const Row& row, double width) const {
    const double plain = observed_.simulated_width;
    return row.blur.front() / (blur_spreads.front() * blur_spreads.front()) * (width * width - plain * plain);
  }

  double base_value(const Row& row, std::span<const double> v) const {
    const auto own = [&](double value) {
      return blurred(value, row, std::sqrt(std::max(0.0, v[Base::own_blur])), v[Base::spectrum]);
    };
    switch (row.reading) {
      case Reading::wall: {
        const Vec3 shift{v[Base::shift], v[Base::shift + 1], v[Base::shift + 2]},
            turn{v[Base::turn], v[Base::turn + 1], v[Base::turn + 2]};
        const double radius = std::clamp(1 / std::max(1e-9, std::abs(row.curvature)), least_radius, largest_radius);
        return own(row.simulated - widened(row, v[Base::width_within])) +
               dot(row.normal, shift + cross(turn, row.at_m)) / observed_.voxel_m + v[Base::bias] +
               v[Base::bias_by_radius] * (std::sqrt(radius / usual_radius) - 1);
      }
      case Reading::width: {
        const double across = row.normal.z * row.normal.z;
        return own(row.simulated) + (v[Base::width_within] - observed_.simulated_width) * (1 - across) +
               (v[Base::width_across] - observed_.simulated_width) * across +
               v[Base::width_between] * 4 * across * (1 - across) +
               v[Base::width_by_curvature] * std::min(1.0, least_radius * std::abs(row.curvature));
      }
      case Reading::inside:
      case Reading::outside: break;
    }
    const double share = own(row.simulated - widened(row, v[Base::width_within]));
    return v[Base::air] + (v[Base::material] - v[Base::air]) * share;
  }

  std::size_t add(Parameter p) {
    parameters_.push_back(std::move(p));
    return parameters_.size() - 1;
  }

  void base_parameters() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const std::string prefix = "volumes/" + input_.name + "/";
    const double size = observed_.voxel_m;
    const auto free = [&](const std::string& name, const std::string& unit, double start, double lower, double upper,
                          double change, std::optional<double> prior) {
      base_.push_back(add({prefix + name, unit, start, start, lower, upper, change, prior, {}}));
    };
    // A shape that turns or slides into itself is held by the priors: fifty voxels, half a radian.
    for (const char* axis : {"x", "y", "z"})
      free(std::string("translation_") + axis + "_m", "m", 0, -infinity, infinity, size, 50 * size);
    for (const char* axis : {"x", "y", "z"})
      free(std::string("rotation_") + axis + "_rad", "rad", 0, -infinity, infinity, size / observed_.field_m, 0.5);
    free("air", "1", 0, -infinity, infinity, 0.01, value_sigma);
    free("material", "1", 1, -infinity, infinity, 0.01, value_sigma);
    const double width = std::clamp(observed_.simulated_width, narrowest, widest);
    for (const char* name : {"edge_width_within_slices", "edge_width_across_slices"})
      free(name, "voxel", width, std::max(narrowest, width - sharper), widest, 0.1, ideal_sigma);
    for (const char* name : {"edge_width_between", "edge_width_by_curvature"})
      free(name, "voxel", 0, -0.3, 0.3, 0.05, ideal_sigma);
    for (const char* name : {"wall_bias", "wall_bias_by_radius"})
      free(name, "voxel", 0, -largest_bias, largest_bias, 0.02, usual_bias);
    free("own_blur_variance", "voxel^2", 0, 0, own_variance, 0.02, usual_own_variance);
    // Says something where edges are blurred alone.
    free("spectrum_variance", "1", volume::usual_variance, 0, largest_variance, 0.1, variance_sigma);
  }

  void enter(const Term& term) {
    if (term.applies != nullptr && !term.applies(observed_)) return;
    const mechanism::Mechanism& m = term.mechanism();
    const auto given = input_.given.find(m.id);
    Use use{&term, parameters_.size(), {}};
    for (const mechanism::Parameter& info : m.parameters) {
      Parameter p{m.id + "." + info.name, info.unit, info.start, info.neutral, info.lower, info.upper,
                  size_of(info),          {},        {}};
      if (given != input_.given.end()) {
        const auto value = given->second.find(info.name);
        if (value != given->second.end() && value->second.given()) p.start = p.neutral = value->second.scalar();
      }
      use.neutral.push_back(info.neutral);
      add(std::move(p));
    }
    const auto place_of = [&](const std::string& name) {
      const auto found = std::ranges::find(m.parameters, name, &mechanism::Parameter::name);
      return use.first + static_cast<std::size_t>(found - m.parameters.begin());
    };
    if (given != input_.given.end()) {
      for (const auto& [name, value] : given->second)
        if (value.given()) base_.push_back(place_of(name));
    } else if (term.forms.empty()) {
      Candidate all{&m, {input_.name}, {}, {}, false};
      for (std::size_t k = 0; k < m.parameters.size(); ++k) all.parameters.push_back(use.first + k);
      candidates_.push_back(std::move(all));
    } else {
      for (const Form& form : term.forms) {
        Candidate one{&m, {input_.name}, {}, m.id, form.finer};
        for (const std::string& name : form.parameters) one.parameters.push_back(place_of(name));
        candidates_.push_back(std::move(one));
      }
    }
    uses_.push_back(std::move(use));
  }
  static double size_of(const mechanism::Parameter& p) {
    return std::max(std::abs(p.start - p.neutral), 0.02 * (p.upper - p.lower));
  }

  void observe() {
    Observations& o = observations_;
    o.first.push_back(0);
    for (std::size_t g = 0; g < observed_.groups; ++g) {
      o.group.push_back("block " + std::to_string(g + 1));
      const auto last = std::ranges::upper_bound(observed_.rows, g, {}, &Row::group);
      o.first.push_back(static_cast<std::size_t>(last - observed_.rows.begin()));
    }
    for (const Row& row : observed_.rows) {
      o.value.push_back(row.value * weight_of(row));
      o.sigma.push_back(row.sigma * weight_of(row));
      o.norm.push_back(1);
      o.block.push_back(row.block);
    }
    o.conditions = volume_conditions(observed_);
  }

  VolumesInput input_;
  Observed observed_;
  std::vector<Use> uses_;
};

}  // namespace

std::unique_ptr<Problem> volumes_problem(VolumesInput input) {
  return std::make_unique<VolumesProblem>(std::move(input));
}

}  // namespace gonio::explain
