// Pictures that could be taken next for a stack of lights: under a lamp from where none stood, and under none.
#include <algorithm>
#include <array>
#include <cmath>

#include "explain/stacks/photometric_problem.h"
#include "manifest/codec.h"

namespace gonio::explain::stacks {
namespace {

constexpr double degree = pi / 180;
constexpr double near_rad = 12 * degree;  // nearer than that a lamp stood already
constexpr std::array<double, 2> zeniths_deg = {25, 50};
constexpr std::array<const char*, 8> sides = {"to the right",       "up and to the right",  "upwards",
                                              "up and to the left", "to the left",          "down and to the left",
                                              "downwards",          "down and to the right"};

}  // namespace

std::vector<PhotometricProblem::Proposed> PhotometricProblem::proposed() const {
  std::vector<Proposed> all = {{"", {}}};
  for (const double zenith : zeniths_deg)
    for (std::size_t k = 0; k < sides.size(); ++k) {
      const double azimuth = static_cast<double>(k) * pi / 4, z = zenith * degree;
      const Vec3 towards =
          normalized(eye_ * std::cos(z) + (right_ * std::cos(azimuth) - down_ * std::sin(azimuth)) * std::sin(z));
      const auto stood = [&](const PatchLight& lamp) { return dot(lamp.towards, towards) > std::cos(near_rad); };
      if (std::ranges::any_of(lamps_, stood)) continue;
      all.push_back(
          {std::to_string(static_cast<int>(zenith)) + " degrees from the camera's axis, " + sides[k], towards});
    }
  return all;
}

std::vector<Proposal> PhotometricProblem::proposals() const {
  std::vector<Proposal> all;
  for (const Proposed& p : proposed()) {
    manifest::Value setup = manifest::Value::object();
    setup["image"] = stack_.images[0].id;
    if (norm(p.towards) > 0) {
      setup["light_towards"] = manifest::Codec<Vec3>::write(p.towards);
      all.push_back({"a picture under a lamp " + p.where, setup});
    } else {
      setup["light"] = manifest::Value::array();
      all.push_back({"image " + stack_.images[0].id + " again with the lamp off", setup});
    }
  }
  return all;
}

// As strong as the others are in the mean; how strong is a number of its own. A patch is known as well as its readings
// tell, all of which count alike.
ProposedRows PhotometricProblem::propose(std::span<const double> values, std::size_t proposal) const {
  const Proposed p = proposed()[proposal];
  const bool dark = !(norm(p.towards) > 0);
  const PatchModel now = model(values);
  PatchLight lamp = lamps_[0];
  lamp.towards = dark ? lamp.towards : p.towards;
  lamp.white = 0;
  for (const PatchLight& other : lamps_) lamp.white += dark ? 0 : other.white / static_cast<double>(lamps_.size());
  ProposedRows rows;
  for (std::size_t s = 0; s < sites_.size(); ++s) {
    const Patch patch_here = patch(values, s);
    const double known =
        static_cast<double>(unknowns()) / static_cast<double>(std::max<std::size_t>(1, sites_[s].seen.size()));
    for (std::size_t c = 0; c < stack_.channels.size(); ++c) {
      const double reading = now(patch_here.b, patch_here.tint[c], lamp, radius(sites_[s].x, sites_[s].y));
      rows.prediction.push_back(reading);
      rows.sigma.push_back(sigma(0, reading, reading) * std::sqrt(1 + (dark ? 0 : known)));
    }
  }
  if (!dark) rows.nuisance.push_back(rows.prediction);
  return rows;
}

}  // namespace gonio::explain::stacks
