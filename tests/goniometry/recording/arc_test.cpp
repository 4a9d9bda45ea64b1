// The arc's plan has as many images as the literature counts, and what it plans can be reduced.
#include <gtest/gtest.h>

#include <set>

#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "manifest/sections/surface.h"
#include "recordings.h"
#include "render/specimen_goniometer.h"
#include "scene/scene.h"

namespace gonio::goniometry {
namespace {

TEST(Arc, StepsGiveThePublishedCount) {
  const render::Arc arc;
  EXPECT_EQ(render::arc_inclinations_rad(arc).size(), 11u);
  EXPECT_EQ(render::arc_azimuths_rad(arc).size(), 23u);
  const manifest::Document d = render::goniometer_specimen(arc);
  EXPECT_EQ(d.lights.size(), 11u);
  const auto images = names_in(d, "images");
  ASSERT_EQ(images.size(), 2783u);
  const scene::Scene scene = scene::build_scene(d);
  for (const scene::View& view : scene.views) {
    const Vec3 at = view.world_from_camera.translation_m;
    EXPECT_GT(at.z, 0.05);
    EXPECT_GT(at.y, 0.004);
  }
  EXPECT_EQ(std::set(images.begin(), images.end()).size(), 2783u);
}

// Steps of 30 degrees: two lamps, two inclinations, five azimuths.
TEST(Arc, WhatIsPlannedCanBeReduced) {
  manifest::Document d = render::goniometer_specimen({.step_rad = pi / 6});
  const auto images = names_in(d, "images");
  ASSERT_EQ(images.size(), 20u);
  const tests::ScratchFolder folder;
  tests::record(d, tests::render_all(d, 4), folder.path(), 1);
  const Reduced reduced = reduce(d);
  EXPECT_EQ(reduced.samples.rows(), 20u);
  const surface::Model& model = *surface::find(d.surfaces["sample"].model);
  const surface::Values values = surface::values_of(model, d.surfaces["sample"].parameters, "");
  for (std::size_t r = 0; r < reduced.samples.rows(); ++r) {
    const Rgb f = model.evaluate(values, reduced.samples.wo[r], reduced.samples.wi[r]);
    for (int b = 0; b < 3; ++b) EXPECT_NEAR(reduced.samples.f[3 * r + b] / f[b], 1, 0.03) << images[r];
  }
}

}  // namespace
}  // namespace gonio::goniometry
