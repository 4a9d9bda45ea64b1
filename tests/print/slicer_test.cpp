#include "print/slicer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <mutex>

#include "base/error.h"
#include "base/parallel.h"
#include "print/compensation.h"
#include "print/cure.h"

namespace gonio::print {
namespace {

constexpr double um = 1e-6;

std::vector<std::uint8_t> greys_of(const LayerPicture& layer, const Printer& printer) {
  return GreyPicture(printer).of(layer);
}

Printer small_printer() {
  Printer p;
  p.name = p.place = "p";
  p.width_px = 40, p.height_px = 30, p.pixel_m = {10 * um, 10 * um}, p.layer_m = 18 * um;
  return p;
}

SlicedBody box(Vec3 low, Vec3 high) {
  SlicedBody b;
  b.name = "box";
  for (int k = 0; k < 8; ++k)
    b.positions_m.push_back({k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z});
  b.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return b;
}

std::vector<LayerPicture> sliced(const Printer& p, const std::vector<SlicedBody>& bodies) {
  std::vector<LayerPicture> all;
  Slicer slicer(p, bodies);
  while (const LayerPicture* layer = slicer.next()) all.push_back(*layer);
  EXPECT_EQ(all.size(), slicer.layers());
  return all;
}
float at(const LayerPicture& l, int x, int y) {
  return l.share[static_cast<std::size_t>((y - l.box.y_begin) * (l.box.x_end - l.box.x_begin) + x - l.box.x_begin)];
}

TEST(Slicer, VolumesOfLayersAddUpToTheBodies) {
  const std::vector<SlicedBody> bodies{box({-155 * um, -93 * um, 0}, {-21 * um, 47 * um, 61 * um}),
                                       box({13 * um, -50 * um, 20 * um}, {88 * um, 50 * um, 100 * um})};
  double sum = 0;
  for (const LayerPicture& l : sliced(small_printer(), bodies)) sum += l.solid_m3;
  const double volume = (134 * 140 * 61 + 75.0 * 100 * 80) * um * um * um;
  EXPECT_NEAR(sum, volume, 1e-6 * volume);
}

// A flat top that ends with a layer is patterned in that layer, also where a 32-bit number put it a little beside.
TEST(Slicer, StructuresTakeTheTopsOfTheirFaces) {
  for (const double off : {0.0, 3e-9, -3e-9}) {
    std::vector<SlicedBody> bodies{box({-100 * um, -100 * um, 0}, {100 * um, 100 * um, 54 * um + off})};
    bodies[0].structure = [](const relief::SurfacePlace& p) { return p.along_m.x < 0 ? 0.25 : 0.75; };
    snap_to_layers(bodies[0], small_printer(), 0);
    const std::vector<LayerPicture> layers = sliced(small_printer(), bodies);
    ASSERT_EQ(layers.size(), 3u);
    EXPECT_FLOAT_EQ(at(layers[1], 15, 15), 1);
    EXPECT_NEAR(at(layers[2], 15, 15), 0.25, 1e-6);
    EXPECT_NEAR(at(layers[2], 25, 15), 0.75, 1e-6);
    EXPECT_NEAR(layers[2].structured_m2, 200 * 200 * um * um, 1e-14);
    EXPECT_NEAR(layers[1].structured_m2, 0, 1e-20);
  }
}

// A top within a layer: what is beneath it is modulated, the side wall's part of the pixel is not there.
TEST(Slicer, StructuresModulateWhatLiesBeneath) {
  std::vector<SlicedBody> bodies{box({-95 * um, -95 * um, 0}, {95 * um, 95 * um, 45 * um})};
  bodies[0].structure = [](const relief::SurfacePlace&) { return 0.5; };
  const std::vector<LayerPicture> layers = sliced(small_printer(), bodies);
  EXPECT_NEAR(at(layers[2], 15, 15), 0.25, 1e-6);
  EXPECT_NEAR(at(layers[2], 10, 15), 0.125, 1e-6);
  EXPECT_FLOAT_EQ(at(layers[0], 15, 15), 1);  // the face below is left
  bodies[0].structured_beneath = true;
  EXPECT_NEAR(at(sliced(small_printer(), bodies)[0], 15, 15), 0.5, 1e-6);
}

TEST(Slicer, LabelsAndAxesOfFacesAreKept) {
  std::vector<SlicedBody> bodies{box({-100 * um, -100 * um, 0}, {100 * um, 100 * um, 18 * um})};
  bodies[0].labels.assign(12, 0);
  bodies[0].labels[2] = bodies[0].labels[3] = 7;
  bodies[0].by_label[7] = [](const relief::SurfacePlace& p) { return p.along_m.y > 0.15 ? 0.9 : 0.1; };
  bodies[0].axes = StructureAxes::texture, bodies[0].texture_m = 0.3;
  for (const Vec3& p : bodies[0].positions_m) bodies[0].texture.push_back({0, p.x > 0 ? 1.0 : 0.0});
  const LayerPicture layer = sliced(small_printer(), bodies)[0];
  EXPECT_NEAR(at(layer, 12, 15), 0.1, 1e-6);
  EXPECT_NEAR(at(layer, 27, 15), 0.9, 1e-6);
}

// The directions that a structure is given on the flat top, and on the roof's slope of 45 degrees towards +y.
TEST(Slicer, AxesLieInTheFaces) {
  std::vector<SlicedBody> bodies{box({-100 * um, -100 * um, 0}, {100 * um, 100 * um, 36 * um})};
  for (Vec3& p : bodies[0].positions_m)
    if (p.z > 0 && p.y > 0) p.y = 64 * um;  // the face towards +y leans by 45 degrees
  for (const Vec3& p : bodies[0].positions_m) bodies[0].texture.push_back({p.y * 1e3, p.x * 1e3});
  std::mutex lock;
  Vec3 u, v;
  bodies[0].structure = [&](const relief::SurfacePlace& p) {
    const std::scoped_lock held(lock);
    if (p.body_m.y > 66 * um) u = p.u, v = p.v;
    return 0.5;
  };
  const double half = std::sqrt(0.5);
  const auto seen = [&](StructureAxes axes, Vec3 expected_u, Vec3 expected_v) {
    bodies[0].axes = axes;
    sliced(small_printer(), bodies);
    EXPECT_NEAR(norm(u - expected_u), 0, 1e-9) << static_cast<int>(axes) << ": " << u.x << ' ' << u.y << ' ' << u.z;
    EXPECT_NEAR(norm(v - expected_v), 0, 1e-9) << static_cast<int>(axes) << ": " << v.x << ' ' << v.y << ' ' << v.z;
  };
  bodies[0].direction = {0, 0, 3};
  seen(StructureAxes::direction, {0, -half, half}, {1, 0, 0});
  seen(StructureAxes::platform, {1, 0, 0}, {0, half, -half});
  seen(StructureAxes::texture, {0, half, -half}, {1, 0, 0});  // a mirrored texture
}

TEST(Slicer, WhatDoesNotFitIsRefused) {
  EXPECT_THROW(Slicer(small_printer(), {box({-300 * um, 0, 0}, {0, 10 * um, 10 * um})}), Error);
  EXPECT_THROW(Slicer(small_printer(), {box({-30 * um, 0, -5 * um}, {0, 10 * um, 10 * um})}), Error);
}

TEST(Slicer, GreysFollowTheGrowth) {
  Printer p = small_printer();
  p.growth = Growth(GrowthLaw{17.71 * um, 10.24 * um, -0.01});
  const std::vector<SlicedBody> bodies{box({-100 * um, -100 * um, 0}, {100 * um, 100 * um, 27 * um})};
  const std::vector<LayerPicture> layers = sliced(p, bodies);
  EXPECT_EQ(greys_of(layers[0], p)[0], 255);
  EXPECT_EQ(greys_of(layers[1], p)[0], std::lround(255 * GrowthLaw{17.71 * um, 10.24 * um, -0.01}.grey(9 * um)));
  EXPECT_NEAR(layers[0].unreached_m3, 200 * 200 * (18 - p.growth.reach_m(18 * um) / um) * um * um * um, 1e-18);
}

TEST(Slicer, IsTheSameForAnyNumberOfThreads) {
  std::vector<SlicedBody> bodies{box({-103 * um, -98 * um, 0}, {77 * um, 101 * um, 75 * um})};
  bodies[0].structure = [](const relief::SurfacePlace& p) { return 0.5 + 0.5 * std::sin(p.along_m.x * 1e5); };
  set_threads(1);
  const std::vector<LayerPicture> one = sliced(small_printer(), bodies);
  set_threads(5);
  const std::vector<LayerPicture> five = sliced(small_printer(), bodies);
  set_threads(0);
  for (std::size_t k = 0; k < one.size(); ++k) EXPECT_EQ(one[k].share, five[k].share);
}

struct Compensated {
  double before_m = 0, after_m = 0;
  std::vector<std::vector<float>> light;
  PixelBox box;
};
Compensated compensated(const Printer& p, const std::vector<SlicedBody>& bodies, int iterations = 200) {
  Slicer slicer(p, bodies);
  Compensation compensation(
      p, slicer.box(), [&] { return slicer.next(); }, iterations);
  Compensated out;
  Misfit before, after;
  for (CompensatedLayer l; compensation.next(l);) {
    before.sum_m2 += l.before.sum_m2, before.voxels += l.before.voxels;
    after.sum_m2 += l.after.sum_m2, after.voxels += l.after.voxels;
    out.box = l.box;
    out.light.emplace_back();
    for (const std::uint8_t g : l.greys) out.light.back().push_back(g / 255.0f);
  }
  out.before_m = before.rms_m(), out.after_m = after.rms_m();
  return out;
}

// Spread by 0.7 px. Within the part the pattern comes out to a tenth of the error; at its walls, where a full pixel
// stands beside an empty one, no light there is could make a step of what spreads: something is left.
TEST(Compensation, MakesUpForSpreadLight) {
  Printer p = small_printer();
  p.growth = Growth(GrowthLaw{26 * um, 10.24 * um, -0.01}), p.bleed = {7 * um, 0.02, 20 * um};
  std::vector<SlicedBody> bodies{box({-100 * um, -100 * um, 0}, {100 * um, 100 * um, 36 * um})};
  bodies[0].structure = [](const relief::SurfacePlace& at) {
    return 0.5 + 0.35 * std::sin(at.along_m.x * 2 * pi / (80 * um));
  };
  const Compensated c = compensated(p, bodies);
  EXPECT_LT(c.after_m, 0.7 * c.before_m);
  const std::vector<LayerPicture> asked = sliced(p, bodies);
  std::vector<std::vector<float>> plain;
  for (const LayerPicture& l : asked) {
    plain.emplace_back();
    for (const std::uint8_t g : greys_of(l, p)) plain.back().push_back(g / 255.0f);
  }
  const auto interior = [&](const std::vector<std::vector<float>>& light, const PixelBox& of) {
    const CuredSurface s = cured(p, of, light, 0);
    double sum = 0;
    for (int y = 10; y < 20; ++y)
      for (int x = 15; x < 25; ++x) {
        const double z = s.top_m[static_cast<std::size_t>((y - of.y_begin) * s.width + x - of.x_begin)];
        sum += std::pow(z - 18 * um * (1 + static_cast<double>(at(asked[1], x, y))), 2);
      }
    return std::sqrt(sum / 100);
  };
  EXPECT_GT(interior(plain, asked[0].box), 0.7 * um);
  EXPECT_LT(interior(c.light, c.box), 0.1 * interior(plain, asked[0].box));
}

// A slab over nothing: without compensation it hangs deep below; with it the first layers are darker, and the surface
// that the cure finds is nearer to the slab's own underside.
TEST(Compensation, MakesUpForOvercure) {
  Printer p = small_printer();
  p.growth = Growth(GrowthLaw{60 * um, 60 * um, 0}), p.overcure_m = 60 * um;
  const std::vector<SlicedBody> bodies{box({-100 * um, -100 * um, 10 * 18 * um}, {100 * um, 100 * um, 22 * 18 * um})};
  const auto underside = [&](const std::vector<std::vector<float>>& light, const PixelBox& of) {
    const CuredSurface s = cured(p, of, light, 0);
    return static_cast<double>(s.underside_m[s.underside_m.size() / 2 + static_cast<std::size_t>(s.width) / 2]);
  };
  std::vector<std::vector<float>> plain;
  Slicer slicer(p, bodies);
  while (const LayerPicture* l = slicer.next()) {
    plain.emplace_back();
    for (const std::uint8_t g : greys_of(*l, p)) plain.back().push_back(g / 255.0f);
  }
  const Compensated c = compensated(p, bodies);
  const double wanted = 180 * um, without = underside(plain, slicer.box()), with = underside(c.light, c.box);
  EXPECT_LT(without, wanted - 60 * um);
  EXPECT_LT(std::abs(with - wanted), 0.35 * std::abs(without - wanted));
  EXPECT_LT(c.after_m, 0.5 * c.before_m);
}

TEST(Compensation, LeavesWhatNeedsNone) {
  const Printer p = small_printer();
  const std::vector<SlicedBody> bodies{box({-100 * um, -100 * um, 0}, {100 * um, 100 * um, 45 * um})};
  const Compensated c = compensated(p, bodies, 20);
  const std::vector<LayerPicture> layers = sliced(p, bodies);
  for (std::size_t k = 0; k < layers.size(); ++k) {
    const std::vector<std::uint8_t> greys = greys_of(layers[k], p);
    for (std::size_t i = 0; i < greys.size(); ++i) EXPECT_EQ(std::lround(255 * c.light[k][i]), greys[i]);
  }
}

}  // namespace
}  // namespace gonio::print
