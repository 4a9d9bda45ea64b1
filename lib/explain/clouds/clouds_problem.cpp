// See clouds_problem.h.
#include "explain/clouds/clouds_problem.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "explain/clouds/clouds_outcome.h"
#include "inference/estimable.h"
#include "inference/explanation.h"
#include "manifest/document.h"

namespace gonio::explain {
namespace {

constexpr double fall =
    1e-6;                    // of squares whose rows are some thousands: less than a hundredth of one degree of freedom
constexpr double never = 2;  // a share: by what is left of a usual change over the noise alone
constexpr double estimable = 0.02;  // share of a parameter's signature that free and earlier parameters must leave

class CloudsProblem final : public Problem {
 public:
  explicit CloudsProblem(CloudsInput input) : input_(std::move(input)), model_(input_) {
    declared_ = cloud_parameters(input_, model_);
    parameters_ = declared_.parameters, base_ = declared_.base;
    observe();
    keep_estimable();
  }

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    model_.predict(declared_.roles, values, group, prediction);
  }
  void jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                std::span<double> derivatives) const override {
    const std::size_t rows = model_.rows(group).size();
    std::vector<std::size_t> own, places;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::vector<std::size_t>& groups = parameters_[columns[c]].groups;
      if (!groups.empty() && std::ranges::find(groups, group) == groups.end()) continue;
      own.push_back(columns[c]), places.push_back(c);
    }
    std::vector<double> found(own.size() * rows);
    Problem::jacobian(values, group, own, found);
    std::ranges::fill(derivatives, 0.0);
    for (std::size_t k = 0; k < own.size(); ++k)
      std::copy_n(found.begin() + static_cast<std::ptrdiff_t>(k * rows), rows,
                  derivatives.begin() + static_cast<std::ptrdiff_t>(places[k] * rows));
  }

  std::string domain() const override { return "clouds"; }
  std::string unit() const override { return "m"; }
  std::string score_name() const override {
    return overlaps() ? "RMS distance from each other" : "RMS distance off the shape";
  }
  std::string group_noun() const override { return overlaps() ? "overlap" : "cloud"; }
  double fit_tolerance() const override { return fall; }
  Importance importance() const override { return Importance::share_of_residual; }

  std::string remarks(const Explanation& e) const override { return clouds_remarks(*this, model_, e); }
  void apply(const Explanation& e, manifest::Document& document) const override {
    upgrade_clouds(*this, input_, declared_, e, document);
  }
  Illustration illustrate(const Explanation& e, const std::filesystem::path&, manifest::Document&) const override {
    return illustrate_clouds(model_, observations_, e);
  }

 private:
  bool overlaps() const { return !input_.against.empty(); }

  void observe() {
    Observations& o = observations_;
    o.first.push_back(0);
    std::uint32_t blocks = 0;
    for (std::size_t v = 0; v < input_.views.size(); ++v) {
      o.group.push_back(input_.views[v].name);
      std::uint32_t last = 0;
      for (std::size_t i = 0; i < model_.rows(v).size(); ++i) {
        const CloudRow& row = model_.rows(v)[i];
        o.value.push_back(model_.value_m(v, i));
        o.sigma.push_back(model_.sigma_m(v, i));
        o.norm.push_back(1);
        const std::uint32_t tile = input_.views[v].tile[row.point];
        o.block.push_back(blocks + tile);
        last = std::max(last, tile + 1);
      }
      blocks += last;
      o.first.push_back(o.value.size());
    }
    number_blocks();
    observe_conditions();
  }

  // Tiles without rows leave no gaps.
  void number_blocks() {
    std::uint32_t next = 0, previous = static_cast<std::uint32_t>(-1);
    for (std::uint32_t& b : observations_.block) {
      const std::uint32_t own = b;
      if (own != previous && previous != static_cast<std::uint32_t>(-1)) ++next;
      previous = own, b = next;
    }
  }

  void observe_conditions() {
    const camera::CameraModel &first = input_.stations[0].lens, &second = input_.stations[1].lens;
    const std::string prefix = input_.projector ? "projector" : "camera";
    Condition phase{"projector.phase", "rad", "light", {}, {}, "m"},
        second_radius{
            prefix + (input_.projector ? ".image-radius" : ".second-image-radius"), "half width", "lens", {}, {}, "m"},
        radius{"camera.image-radius", "half width", "lens", {}, {}, "m"},
        x{"camera.image-x", "half width", "pose", {}, {}, "m"}, y{"camera.image-y", "half width", "pose", {}, {}, "m"},
        incidence{"surface.incidence-angle", "rad", "surface", {}, {}, "m"},
        depth{"scene.depth", "m", "pose", {}, {}, "m"}, slope{"camera.brightness-slope", "1/px", "lens", {}, {}, "m"},
        openness{"surface.openness", "1", "transport", {}, {}, "m"}, later{"camera.time", "s", "pose", {}, {}, "m"},
        warmer{"camera.temperature", "K", "pose", {}, {}, "m"};
    const auto place = [](const camera::CameraModel& lens, Vec2 pixel) {
      return (pixel - lens.principal_point_px()) * (2.0 / lens.width_px());
    };
    const scan::ToldPlace& told = model_.told_place(model_.telling());
    for (std::size_t v = 0; v < input_.views.size(); ++v)
      for (std::size_t i = 0; i < model_.rows(v).size(); ++i) {
        const CloudRow& row = model_.rows(v)[i];
        const Vec2 a = place(first, row.pixel), b = place(second, row.expected);
        const double u = model_.telling() == scan::Axis::column ? row.expected.x : row.expected.y;
        phase.values.push_back(told.finest_phase(u) - 2 * pi * std::floor(told.finest_phase(u) / (2 * pi)));
        second_radius.values.push_back(std::hypot(b.x, b.y)), radius.values.push_back(std::hypot(a.x, a.y));
        x.values.push_back(a.x), y.values.push_back(a.y);
        incidence.values.push_back(row.incidence_rad), depth.values.push_back(row.depth_m);
        slope.values.push_back(slope_along_told(row)), openness.values.push_back(1 - model_.indirect(v).hidden(i));
        later.values.push_back(input_.views[v].later_s), warmer.values.push_back(input_.views[v].warmer_K);
      }
    for (Condition* c :
         {&phase, &second_radius, &radius, &x, &y, &incidence, &depth, &slope, &openness, &later, &warmer}) {
      const auto [low, high] = std::ranges::minmax_element(c->values);
      if (*low < *high && (c != &phase || (input_.projector && told.any())))
        observations_.conditions.push_back(std::move(*c));
    }
  }

  // The change of log brightness along the way by which the pixel told is another; it has a sign.
  static double slope_along_told(const CloudRow& row) {
    const Vec2 way{dot(row.across[0], row.along), dot(row.across[1], row.along)};
    const double length = std::hypot(way.x, way.y);
    return length > 0 ? dot(row.slope, way) / length : 0;
  }

  // A shape along which its own points slide: a groove along its edge, a turned part about its axis.
  void hold_what_slides() {
    const std::vector<double> values = neutral_values();
    std::vector<std::size_t> shapes, kept;
    std::vector<Estimable::Column> columns;
    std::vector<double> usual;
    for (const std::size_t p : base_) {
      if (declared_.roles[p].part != CloudRole::Part::shape) {
        kept.push_back(p);
        continue;
      }
      shapes.push_back(p), columns.push_back(whitened_slopes(*this, p, values)), usual.push_back(parameters_[p].size);
    }
    for (const std::size_t k : Estimable({}).kept(columns, never, usual)) kept.push_back(shapes[k]);
    std::ranges::sort(kept);
    base_ = std::move(kept);
  }

  std::vector<double> neutral_values() const {
    std::vector<double> values;
    for (const Parameter& p : parameters_) values.push_back(p.neutral);
    return values;
  }

  void keep_estimable() {
    hold_what_slides();
    const std::vector<double> values = neutral_values();
    const auto columns_of = [&](const std::vector<std::size_t>& parameters) {
      std::vector<Estimable::Column> columns;
      for (const std::size_t p : parameters) columns.push_back(whitened_slopes(*this, p, values));
      return columns;
    };
    const Estimable beside(columns_of(base_));
    for (Candidate c : declared_.candidates) {
      std::vector<std::size_t> kept;
      std::vector<double> usual;
      for (const std::size_t p : c.parameters) usual.push_back(parameters_[p].size / size_of_usual);
      for (const std::size_t k : beside.kept(columns_of(c.parameters), estimable, usual))
        kept.push_back(c.parameters[k]);
      c.parameters = kept;
      if (!kept.empty()) candidates_.push_back(std::move(c));
    }
  }

  CloudsInput input_;
  CloudModel model_;
  CloudParameters declared_;
};

}  // namespace

std::unique_ptr<Problem> clouds_problem(CloudsInput input) {
  return std::make_unique<CloudsProblem>(std::move(input));
}

}  // namespace gonio::explain
