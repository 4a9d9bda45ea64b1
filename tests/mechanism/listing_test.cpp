// The registry is complete and fit to be read: the list of ids that explain owes its users is written here once.
#include "mechanism/listing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <iterator>
#include <set>
#include <sstream>

namespace gonio::mechanism {
namespace {

std::set<std::string> words(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

const std::set<std::string> owed = words(
    "lens.radial lens.tangential lens.thin-prism lens.fisheye lens.lateral-colour lens.non-central "
    "optics.vignetting optics.veiling-glare optics.ghost optics.defocus sensor.black-offset "
    "sensor.non-linearity sensor.saturation sensor.clipped-resampling sensor.prnu sensor.row-pattern "
    "sensor.shutter sensor.crosstalk camera.rolling-shutter camera.thermal board.warp board.scale "
    "board.corner-bias light.direction light.position light.inverse-square light.finite-size light.lobe "
    "light.ambient light.second-source light.drift light.spectrum light.near-environment light.polarization "
    "surface.diffuse-roughness surface.interface surface.specular surface.anisotropy surface.retro-reflection "
    "surface.thin-film surface.spatial-variation surface.subsurface surface.fluorescence surface.micro-ridges "
    "volume.absorption volume.index volume.dispersion geometry.pose geometry.scale geometry.offset "
    "geometry.contact transport.indirect transport.caustic robot.joint-offset robot.link-length robot.sag "
    "robot.backlash robot.thermal robot.time-offset tracks.perspective tracks.outliers reference.tile");
// Terms of simulators that do not exist yet; they are declared with them.
const std::set<std::string> of_other_simulators = {"geometry.beam-hardening"};
// Beyond the list: a rational lens is a family of the radial one; residue on a micro-structure, and its walls; a scale
// for every frame of a film; what a tomograph does to a volume; what heats an arm's joints; what glue
// and glass do to markers; the part of a lens' glare that falls with distance; single pictures of another exposure, and
// cards beside lamps; what a board calibration frees anyway, and where a camera stands; what a tracker shows of a
// machine; air that scatters; what a mirror ball's light, place and metal were taken for; what moved between two
// exposures; light that lies on a chart; what full pixels give their neighbours, what some gather
// in the dark, what filters that are not the eye's do to colours, what an open aperture loses at a rim; what
// bends the points of structured light; sizes that differ from a model's along each axis, what curls, and
// light that masks of shadows leave out; how rough glass and metal are and where, and light beneath a surface that
// remembers where it was going; what a printer does to the heights of what it prints; what polarizers of cameras and
// screens do, and what stands between.
const std::set<std::string> besides = words(
    "lens.rational surface.residue surface.walls tracks.scale ct.threshold ct.scale ct.blur ct.cupping "
    "ct.beam-hardening ct.scatter ct.ring ct.streak ct.axis-tilt robot.warm-up robot.joule-heating "
    "robot.friction-heating marker.offset marker.refracted sensor.exposure light.reflector surface.metal surface.coat "
    "surface.sheen surface.translucent optics.bloom camera.flat-port camera.focal-length "
    "camera.principal-point camera.aspect camera.pose board.print board.shape robot.axis-scale robot.squareness "
    "robot.compliance volume.fog probe.distance probe.centre probe.reflectance scene.moved sensor.dark-current "
    "colour.glare sensor.blooming sensor.hot-pixel colour.metamerism optics.lens-shading projector.gamma "
    "projector.lens projector.moved rig.drift structured-light.subsurface structured-light.motion "
    "structured-light.interreflection structured-light.edge structured-light.defocus geometry.shrinkage "
    "geometry.bend ground.not-flat mask.caustic surface.roughness surface.print-slopes surface.print-layers "
    "surface.polish surface.directional-subsurface print.growth print.bleed print.overcure print.layer-shift "
    "print.shrinkage print.membrane print.pixel-tilt print.ground-noise polarizer.leak polarizer.angle "
    "lens.birefringence screen.leak screen.angle retarder.dispersion surface.coating");

// Owed and not there yet: printed, until they are declared and leave this list.
const std::set<std::string> awaited = {};

TEST(Registry, HoldsWhatIsOwed) {
  std::string missing, waiting;
  for (const std::string& id : owed) {
    if (find_mechanism(id) != nullptr) continue;
    std::string& list = awaited.contains(id) ? waiting : missing;
    list += (list.empty() ? "" : ", ") + id;
  }
  EXPECT_EQ(missing, "");
  if (!waiting.empty()) std::cout << "still awaited: " << waiting << "\n";
  for (const Mechanism* m : all_mechanisms())
    EXPECT_TRUE(owed.contains(m->id) || of_other_simulators.contains(m->id) || besides.contains(m->id))
        << m->id << " is no canonical id";
}

TEST(Registry, EveryDeclarationSaysWhatAReaderNeeds) {
  for (const Mechanism* m : all_mechanisms()) {
    EXPECT_FALSE(m->sentence.empty()) << m->id;
    EXPECT_TRUE(m->sentence.ends_with(".")) << m->id << ": " << m->sentence;
    EXPECT_FALSE(m->typical.empty()) << m->id;
    EXPECT_FALSE(m->equation.empty()) << m->id;
    EXPECT_FALSE(m->source.empty()) << m->id;
    EXPECT_FALSE(m->parameters.empty()) << m->id;
    EXPECT_FALSE(m->conditions.empty()) << m->id;
    EXPECT_FALSE(m->mistaken_for.empty()) << m->id;
    for (const Confusion& c : m->mistaken_for) EXPECT_FALSE(c.told_apart.empty()) << m->id << " and " << c.with;
    for (const Parameter& p : m->parameters) {
      EXPECT_FALSE(p.meaning.empty()) << m->id << " " << p.name;
      EXPECT_LT(p.lower, p.upper) << m->id << " " << p.name;
      EXPECT_GE(p.start, p.lower) << m->id << " " << p.name;
      EXPECT_LE(p.start, p.upper) << m->id << " " << p.name;
      EXPECT_GE(p.typical, 0) << m->id << " " << p.name;
      EXPECT_LE(p.typical, p.upper - p.lower) << m->id << " " << p.name;
    }
  }
}

// A usual deviation is a prior of what is fitted: the number that a mechanism vanishes with has one, unless it goes
// with the unit of the picture.
TEST(Registry, DeviationsHaveAUsualSize) {
  const std::set<std::string> in_units_of_the_scene = {"light.ambient", "sensor.black-offset", "sensor.dark-current",
                                                       "sensor.saturation"};
  for (const Mechanism* m : all_mechanisms()) {
    const bool stated = std::ranges::any_of(m->parameters, [](const Parameter& p) { return p.typical > 0; });
    EXPECT_EQ(stated, !in_units_of_the_scene.contains(m->id)) << m->id;
  }
  EXPECT_EQ(find_mechanism("light.position")->parameters[0].typical, 0.005);
  EXPECT_NE(text().find("usually off by 0.005 m"), std::string::npos);
}

// A confusion names another mechanism by its id, a model of a surface or a light, or is a plain word: any other id is a
// slip.
TEST(Registry, ConfusionsNameWhatExists) {
  for (const Mechanism* m : all_mechanisms())
    for (const Confusion& c : m->mistaken_for) {
      const bool looks_like_id = c.with.find('.') != std::string::npos && c.with.find(' ') == std::string::npos;
      const bool known = find_mechanism(c.with) != nullptr || owed.contains(c.with) ||
                         of_other_simulators.contains(c.with) || c.with == "surface.metal";
      EXPECT_TRUE(known || !looks_like_id) << m->id << " is mistaken for " << c.with;
    }
}

TEST(Listing, EveryMechanismStandsUnderItsStageOnce) {
  std::size_t count = 0;
  for (const Stage& stage : by_stage()) {
    EXPECT_NE(stage.sentence, stage.name) << "stage " << stage.name << " has no words";
    for (const Mechanism* m : stage.mechanisms) EXPECT_EQ(m->stage, stage.name);
    count += stage.mechanisms.size();
  }
  EXPECT_EQ(count, all_mechanisms().size());
  const std::string listed = text(), manual = markdown();
  for (const Mechanism* m : all_mechanisms()) {
    EXPECT_NE(listed.find("\n" + m->id + "\n"), std::string::npos) << m->id;
    EXPECT_NE(manual.find("## " + m->id + "\n"), std::string::npos) << m->id;
  }
  for (std::size_t at = 0; at < listed.size();) {
    const std::size_t end = listed.find('\n', at);
    if (listed.substr(at, end - at).find(' ') != std::string::npos) {
      EXPECT_LE(end - at, 120u) << listed.substr(at, end - at);
    }
    at = end + 1;
  }
}

}  // namespace
}  // namespace gonio::mechanism
