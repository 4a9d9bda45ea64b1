// The lamps of a table of irradiances: their parameters, the mechanisms that edit them (scene/mechanisms.h, so that
// `render` and a table mean the same), and the irradiance that they make on small planes.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "explain/engine.h"
#include "explain/tables/table_model.h"
#include "scene/mechanisms.h"

namespace gonio::explain::tables {

struct LampNumber {                         // which number of which lamp a parameter of the problem is
  std::size_t lamp = 0;                     // lamps().size(): the second source, which shines on every row
  std::string name;                         // of the lamp's parameter, or
  const mechanism::Mechanism* m = nullptr;  // of this mechanism
  std::size_t component = 0;                // of a vector; of the mechanism's parameters
};

class LampState {
 public:
  // `names`: entries of the document's lights. `centre_m`: of the points, about which directions are turned.
  LampState(const manifest::Document& document, const std::vector<std::string>& names, Vec3 centre_m,
            std::span<const Vec3> points_m, const std::string& place);

  const std::vector<scene::Light>& lamps() const { return appearance_.lights; }
  const std::vector<Parameter>& parameters() const { return parameters_; }
  const std::vector<std::size_t>& base() const { return base_; }
  const std::vector<Candidate>& candidates() const { return candidates_; }
  const std::vector<LampNumber>& numbers() const { return numbers_; }

  // The lamps with these values of parameters(); behind them the second source, where it is in play.
  std::vector<scene::Light> at(std::span<const double> values) const;
  void apply(std::span<const double> values, std::span<const double> sigma, manifest::Document& document) const;

 private:
  void free_parameters(const manifest::Document& document);
  void mechanisms_of_lamps(std::span<const Vec3> points_m);
  void form_of_lamp(const mechanism::Mechanism& m, std::size_t lamp, std::span<const std::size_t> numbers,
                    const std::string& form);
  void lobes_of_lamp(std::size_t lamp, std::span<const Vec3> points_m);
  void second_source();
  scene::Light second_lamp(std::span<const double> numbers) const;
  void add(Parameter parameter, LampNumber number);

  scene::Appearance appearance_;
  Vec3 centre_m_;
  std::string place_;
  std::vector<Parameter> parameters_;
  std::vector<LampNumber> numbers_;
  std::vector<std::size_t> base_;
  std::vector<Candidate> candidates_;
};

// light.second-source in a table, as declared: a point as far from the centre as the first lamp is (a directional one:
// parallel light), so that its irradiance of a plane differs from that of even ambient light. Its direction is not
// found by small steps: four quarters of the horizon are alternatives of one family. Irradiance of an unoccluded lamp
// on a small plane, W/m^2: in closed form for points and spheres, else the mean over a regular grid of the lamp's own
// samples (12 x 12, a midpoint rule).
class LampLight {
 public:
  explicit LampLight(const scene::Light& lamp);  // which outlives it
  Rgb irradiance(Vec3 point_m, Vec3 normal) const;

 private:
  const scene::Light& lamp_;
  bool small_ = false;  // a point or a sphere
  Rgb intensity_;
  Vec3 position_m_;
  double radius_m_ = 0;
};

// Where the lamp is as seen from a point: direction to it, distance (infinite ones: along the rays, from the centre)
// and the angle between its axis and the way to the point (lamps without one face the centre).
struct Sight {
  Vec3 towards;
  double distance_m = 0, emission_rad = 0;
};
Sight sight_of(const scene::Light& lamp, Vec3 point_m, Vec3 centre_m);

}  // namespace gonio::explain::tables
