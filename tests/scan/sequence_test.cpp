// What a projector shows: Gray codes in OpenCV's order, cosines, and what a manifest must say of them.
#include "scan/sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "base/error.h"
#include "geom/vector.h"
#include "manifest/document.h"
#include "manifest/sections/projection.h"

namespace gonio::scan {
namespace {

constexpr Axis both[] = {Axis::column, Axis::row};

// As OpenCV 4.6 makes them (GrayCodePattern_Impl::generate), written from its description: bit k of a column is dark
// where it equals the next coarser one.
TEST(Sequence, GrayCodeIsThatOfOpenCv) {
  const Sequence s = gray_sequence(1920, 1080, both);
  ASSERT_EQ(s.frames.size(), 46u);
  for (const int column : {0, 1, 2, 3, 700, 1023, 1024, 1919})
    for (int k = 0; k < 11; ++k) {
      const bool lit = ((column >> k) & 1) != ((column >> (k + 1)) & 1);
      const auto frame = static_cast<std::size_t>(2 * 11 - 2 * k - 2);
      EXPECT_EQ(light_at(s, frame, column, 500), lit ? 1 : 0) << column << " " << k;
      EXPECT_EQ(light_at(s, frame + 1, column, 500), lit ? 0 : 1);
    }
  EXPECT_EQ(s.frames[44].what, Shown::What::white);
  EXPECT_EQ(s.frames[45].what, Shown::What::black);
}

TEST(Sequence, GrayCodesOfNeighboursDifferInOneBitAndAreReadBack) {
  for (int n = 0; n < 4096; ++n) {
    EXPECT_EQ(number_of_gray(gray_code(n)), n);
    const int changed = gray_code(n) ^ gray_code(n + 1);
    EXPECT_EQ(changed & (changed - 1), 0) << n;
  }
}

// Sums over a projector's pixel, by many small parts.
TEST(Sequence, CosinesAreTheMeanOverAPixel) {
  const double periods[] = {1.5, 40};
  const Sequence s = cosine_sequence(200, 100, both, periods, 5);
  ASSERT_EQ(s.frames.size(), 20u);
  for (const std::size_t frame : {std::size_t{0}, std::size_t{3}, std::size_t{7}, std::size_t{19}}) {
    const Shown& f = s.frames[frame];
    const double size = f.axis == Axis::column ? 200 : 100;
    for (const int u : {0, 13, 57, 99}) {
      double mean = 0;
      for (int k = 0; k < 1000; ++k)
        mean += 0.5e-3 + 0.5e-3 * std::cos(2 * pi * f.periods * (u + (k + 0.5) / 1000) / size - f.shift_rad);
      EXPECT_NEAR(light_at(s, frame, f.axis == Axis::column ? u : 3, f.axis == Axis::row ? u : 3), mean, 1e-6);
    }
  }
}

TEST(Sequence, LinesCoverEveryPixelOnceAndBitsTellThemApart) {
  for (const int period : {6, 8, 15, 16}) {
    const Sequence s = line_sequence(100, 60, both, period);
    std::map<int, int> lit;
    int finest = 9;
    for (std::size_t f = 0; f < s.frames.size(); ++f) {
      if (s.frames[f].what == Shown::What::bit) finest = std::min(finest, s.frames[f].bit);
      if (s.frames[f].what != Shown::What::line || s.frames[f].axis != Axis::column) continue;
      for (int u = 0; u < 100; ++u) lit[u] += light_at(s, f, u, 7) == 1 ? 1 : 0;
    }
    for (int u = 0; u < 100; ++u) EXPECT_EQ(lit[u], 1) << u;
    EXPECT_LE(2 << finest, period);        // stripes of half a period
    EXPECT_GT(2 * (2 << finest), period);  // and no finer
  }
}

TEST(Sequence, GoesThroughAManifest) {
  const double periods[] = {1, 16};
  for (const Sequence& s : {gray_sequence(640, 480, both), cosine_sequence(640, 480, both, periods, 4),
                            line_sequence(640, 480, both, 10)}) {
    manifest::Document d;
    d.projections["p"] = projection_of(s);
    const Sequence read = sequence_of(d, "p");
    ASSERT_EQ(read.frames.size(), s.frames.size());
    for (std::size_t f = 0; f < s.frames.size(); ++f) EXPECT_EQ(read.frames[f], s.frames[f]) << f;
  }
}

TEST(Sequence, WhatSaysTooLittleIsRefused) {
  const double periods[] = {1, 16};
  const auto refused = [](const Sequence& s) -> std::string {
    manifest::Document d;
    d.projections["p"] = projection_of(s);
    try {
      sequence_of(d, "p");
    } catch (const Error& e) {
      return e.what();
    }
    return "taken";
  };
  Sequence gray = gray_sequence(640, 480, both);
  gray.frames.erase(gray.frames.begin() + 4, gray.frames.begin() + 6);
  EXPECT_THAT(refused(gray), testing::HasSubstr("shows no bit 7 of columns"));
  gray = gray_sequence(640, 480, both);
  gray.frames.push_back(gray.frames[0]);
  EXPECT_THAT(refused(gray), testing::HasSubstr("shows bit 9 of columns twice"));
  gray = gray_sequence(640, 480, both);
  gray.width_px = 1920;
  EXPECT_THAT(refused(gray), testing::HasSubstr("there are 1920 columns"));
  EXPECT_THAT(refused(cosine_sequence(640, 480, both, periods, 2)), testing::HasSubstr("at 2 shifts"));
  Sequence lines = line_sequence(640, 480, both, 8);
  std::erase_if(lines.frames, [](const Shown& f) { return f.what == Shown::What::line && f.offset_px == 3; });
  EXPECT_THAT(refused(lines), testing::HasSubstr("at 7 of 8 offsets"));
  EXPECT_THAT(refused(line_sequence(640, 480, both, 5)), testing::HasSubstr("5 pixels apart"));
  lines = line_sequence(640, 480, both, 8);
  std::erase_if(lines.frames, [](const Shown& f) { return f.what == Shown::What::bit && f.bit < 3; });
  EXPECT_THAT(refused(lines), testing::HasSubstr("no bits that tell its lines apart"));
  EXPECT_THAT(refused({640, 480, {{.what = Shown::What::white}}}), testing::HasSubstr("neither columns nor rows"));
}

}  // namespace
}  // namespace gonio::scan
