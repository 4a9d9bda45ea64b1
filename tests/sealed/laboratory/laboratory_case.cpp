// See laboratory_case.h.
#include "sealed/laboratory/laboratory_case.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "acquisition/desk/specimen_laboratory.h"
#include "geom/rigid.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"

namespace gonio::sealed {
namespace {

// What shows it: explain's domain.
constexpr const char *arm = "robot", *lens_domain = "boards", *light = "images";

struct Offer {
  std::string domain;
  std::function<Perturbation(Random&)> draw;
};

// Sizes are spread evenly over their logarithm, about what occurs in practice.
double size(Random& random, double least, double most) {
  return least * std::pow(most / least, random.uniform());
}
double either(Random& random, double least, double most) {
  return (random.uniform() < 0.5 ? -1 : 1) * size(random, least, most);
}
std::string joint(const char* before, std::uint32_t first, std::uint32_t count, const char* after, Random& random) {
  return before + std::to_string(first + random.below(count)) + after;
}

std::vector<Offer> offers_of_arm_and_lens() {
  return {{arm,
           [](Random& r) {
             const std::string which = joint("joint_", 2, 4, "_rad", r);
             return Perturbation{arm, "robot.joint-offset", {}, which, either(r, 5e-4, 5e-3), "", "", 0};
           }},
          {arm,
           [](Random& r) {
             return Perturbation{arm, "robot.sag", {}, "joint_2_rad_per_m", either(r, 5e-4, 5e-3), "", "", 0};
           }},
          {arm,
           [](Random& r) {
             const std::string which = joint("backlash_", 2, 4, "_rad", r);
             return Perturbation{arm, "robot.backlash", {}, which, size(r, 3e-4, 3e-3), "", "", 0};
           }},
          {arm,
           [](Random& r) {
             const std::string which = joint("a_", 2, 2, "_m", r);
             return Perturbation{arm, "robot.link-length", {}, which, either(r, 3e-4, 3e-3), "", "", 0};
           }},
          {arm,
           [](Random& r) {
             return Perturbation{arm, "board.scale", {}, "scale_x", either(r, 1e-3, 1e-2), "geometry.scale", "", 0};
           }},
          {lens_domain,
           [](Random& r) {
             return Perturbation{lens_domain, "lens.radial", {"lens.rational"}, "k1", either(r, 0.02, 0.2), "", "", 0};
           }},
          {lens_domain, [](Random& r) {
             return Perturbation{lens_domain, "lens.tangential", {}, "p1", either(r, 2e-3, 1e-2), "", "", 0};
           }}};
}

std::vector<Offer> offers_of_light() {
  return {{light,
           [](Random& r) {
             return Perturbation{light, "optics.vignetting", {}, "falloff", size(r, 0.05, 0.3), "", "", 0};
           }},
          {light,
           [](Random& r) {
             const double size_of_it = either(r, 0.06, 0.25);
             return Perturbation{light,         "light.drift", {}, "amplitude", size_of_it, "", "time_constant_s",
                                 size(r, 8, 20)};
           }},
          {light,
           [](Random& r) {
             const std::string along = r.uniform() < 0.5 ? "shift_x_m" : "shift_y_m";
             return Perturbation{light, "light.position", {"light.direction"}, along, either(r, 0.04, 0.09), "", "", 0};
           }},
          {light,
           [](Random& r) {
             return Perturbation{light, "light.ambient", {}, "radiance_g", size(r, 0.01, 0.08), "", "", 0};
           }},
          {light,
           [](Random& r) {
             return Perturbation{light, "sensor.black-offset", {}, "offset", either(r, 2e-4, 2e-3), "", "", 0};
           }},
          {light,
           [](Random& r) {
             return Perturbation{light, "sensor.non-linearity", {}, "quadratic", either(r, 0.04, 0.2), "", "reference",
                                 0.05};
           }},
          {light, [](Random& r) {
             return Perturbation{light, "optics.veiling-glare", {}, "share", size(r, 0.02, 0.08), "", "", 0};
           }}};
}

std::vector<Offer> offers() {
  std::vector<Offer> all = offers_of_arm_and_lens();
  for (const Offer& offer : offers_of_light()) all.push_back(offer);
  return all;
}

// The deck of offers lies in its order, and is laid out again when it is used up. The first card whose part is not
// `other` is taken off.
std::size_t taken_off(std::vector<std::size_t>& deck, const std::vector<Offer>& all, const std::string& other) {
  const auto fits = [&](std::size_t k) { return all[k].domain != other; };
  if (std::ranges::none_of(deck, fits))
    for (std::size_t k = 0; k < all.size(); ++k) deck.push_back(k);
  const auto found = std::ranges::find_if(deck, fits);
  const std::size_t card = *found;
  deck.erase(found);
  return card;
}

// A quarter of the laboratories have nothing to find, a quarter two things, of different parts: of every four the
// first has none, the others one, one and two.
std::vector<Perturbation> drawn(std::uint64_t seed, Random& random) {
  const std::vector<Offer> all = offers();
  std::vector<std::size_t> deck, cards;
  for (std::uint64_t k = 1; k <= seed; ++k) {
    cards.clear();
    const std::uint64_t place = (k - 1) % 4;
    if (place > 0) cards.push_back(taken_off(deck, all, ""));
    if (place == 3) cards.push_back(taken_off(deck, all, all[cards[0]].domain));
  }
  std::vector<Perturbation> perturbations;
  for (const std::size_t card : cards) perturbations.push_back(all[card].draw(random));
  return perturbations;
}

manifest::Document described(bool small, const std::filesystem::path& folder) {
  manifest::Document d = acquisition::specimen_laboratory("desk", folder);
  manifest::Camera& lens = d.cameras.at("camera");
  lens = {};
  lens.model = "pinhole";
  lens.width_px = small ? 320 : 480;
  lens.height_px = small ? 240 : 360;
  lens.fx_px = lens.fy_px = small ? 373 : 560;
  lens.cx_px = 0.5 * (lens.width_px - 1);
  lens.cy_px = 0.5 * (lens.height_px - 1);
  manifest::Light& lamp = d.lights.at("lamp");
  lamp = {};
  lamp.model = "point";
  lamp.parameters["position_m"] = manifest::Parameter(std::vector<double>{0.25, -0.15, 0.7});
  manifest::Parameter power(1.2);
  power.free = true;
  lamp.parameters["watt_per_sr"] = power;
  d.laboratory.entry.front().lamps.at("lamp").in_world_m = {0.25, -0.15, 0.7};
  return d;
}

void enter(const Perturbation& p, manifest::Document& truth) {
  manifest::MechanismUse& use = truth.mechanisms[p.acts_as.empty() ? p.mechanism : p.acts_as];
  if (p.acts_as == "geometry.scale") {
    use.on = {"sheet"};
    use.parameters["growth"] = manifest::Parameter(p.value);
    return;
  }
  use.parameters[p.parameter] = manifest::Parameter(p.value);
  if (!p.also_parameter.empty()) use.parameters[p.also_parameter] = manifest::Parameter(p.also_value);
  if (p.mechanism == "light.ambient")
    for (const char* band : {"radiance_r", "radiance_b"}) use.parameters[band] = manifest::Parameter(p.value);
}

}  // namespace

LaboratoryCase laboratory_with(std::uint64_t seed, std::vector<Perturbation> perturbations, bool small,
                               const std::filesystem::path& folder) {
  LaboratoryCase made;
  made.seed = seed;
  made.perturbations = std::move(perturbations);
  made.believed = described(small, folder);
  Random random(seed, 2);
  const auto about = [&random](double half) { return random.uniform(-half, half); };
  made.truth.cameras = made.believed.cameras;
  manifest::Camera& lens = made.truth.cameras.at("camera");
  lens.fx_px = lens.fx_px.scalar() * (1 + about(0.01));
  lens.fy_px = lens.fx_px;
  lens.cx_px = lens.cx_px.scalar() + about(3);
  lens.cy_px = lens.cy_px.scalar() + about(3);
  made.truth.lights = made.believed.lights;
  made.truth.lights.at("lamp").parameters.at("watt_per_sr").value.front() *= 1 + about(0.05);
  made.truth.laboratory = made.believed.laboratory;
  auto& mount = *made.truth.laboratory.entry.front().cameras.at("camera").tool_from_camera;
  mount.translation_m += Vec3{about(0.003), about(0.003), about(0.003)};
  mount.rotation = normalized(quaternion_of_rotation_vector({about(0.01), about(0.01), about(0.01)}) * mount.rotation);
  for (const Perturbation& p : made.perturbations) enter(p, made.truth);
  const std::string views = small ? "8" : "20";
  made.plan = {"--plan", "board:views=" + views + ",tilt=38deg,nearest=24cm,farthest=38cm", "--shuffle", "--seed",
               std::to_string(seed)};
  const std::vector<std::string> light_and_dark{"--plan", "hdr:shortest=1.25ms,longest=10ms,radius=30cm",
                                                "--dark-every", "12"};
  if (!small) made.plan.insert(made.plan.end(), light_and_dark.begin(), light_and_dark.end());
  return made;
}

LaboratoryCase laboratory_case(std::uint64_t seed, bool small, const std::filesystem::path& folder) {
  Random random(seed, 1);
  return laboratory_with(seed, drawn(seed, random), small, folder);
}

}  // namespace gonio::sealed
