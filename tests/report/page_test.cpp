#include "report/page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "report/colour_map.h"
#include "report/floor_plan.h"
#include "report/number_text.h"

namespace gonio::report {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Page, EscapesWhatItIsGiven) {
  Page page("a<b", "\"quoted\" & <script>alert(1)</script>", "");
  page.section("<i>");
  page.table({.caption = "<u>", .columns = {{"<b>", "m"}}, .rows = {{"<s>"}}});
  page.figures({{.png = "", .title = "\" onerror=\"alert(1)"}});
  const std::string html = page.html();
  for (const char* bad : {"<script>alert", "<i>", "<u>", "<s>", "\" onerror=\""})
    EXPECT_THAT(html, Not(HasSubstr(bad)));
  EXPECT_THAT(html, HasSubstr("&lt;script&gt;alert(1)"));
}

TEST(Page, RefersToNothingOutside) {
  Page page("t", "h", "l");
  page.section("s");
  page.plot({.title = "p", .series = {{.x = {1, 2}, .y = {3, 4}}}});
  for (const char* bad : {"http:", "https:", "src=\"//", "@import", "url("})
    EXPECT_THAT(page.html(), Not(HasSubstr(bad))) << bad;
}

TEST(Page, Base64) {  // RFC 4648, section 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(Plot, TicksAreRoundAndInside) {
  EXPECT_THAT(tick_positions(0, 1, 5),
              testing::Pointwise(testing::DoubleNear(1e-12), std::vector<double>{0, 0.2, 0.4, 0.6, 0.8, 1}));
  EXPECT_THAT(tick_positions(-3, 7, 5),
              testing::Pointwise(testing::DoubleNear(1e-12), std::vector<double>{-2, 0, 2, 4, 6}));
  EXPECT_THAT(log_tick_positions(0.001, 10, 5),
              testing::Pointwise(testing::DoubleNear(1e-9), std::vector<double>{0.001, 0.01, 0.1, 1, 10}));
  EXPECT_TRUE(tick_positions(1, 1, 5).empty());
}

TEST(Plot, DrawsNoNumberThatIsNone) {
  const double nan = std::nan("");
  Plot plot{.title = "p",
            .series = {{.x = {1, 2, nan, 4}, .y = {1, nan, 2, 3}},
                       {.kind = Series::Kind::points, .x = {1}, .y = {2}, .sigma = {nan}}}};
  for (const bool logarithmic : {false, true}) {
    plot.log_y = plot.log_x = logarithmic;
    EXPECT_THAT(svg(plot), Not(HasSubstr("nan")));
    EXPECT_THAT(svg(plot), Not(HasSubstr("inf")));
  }
  plot.series.clear();
  EXPECT_THAT(svg(plot), Not(HasSubstr("nan")));
}

// The camera stands 0.7 m before the scene; 0.14 m across and 0.7 m deep at one scale, which the bar tells.
TEST(FloorPlan, IsToScale) {
  const FloorPlan plan{
      "lamp & scene", {"camera"}, {"the scene", 0.1, 0.7}, {"lamp today", -0.04, 0.6}, {"then", 0, 0.5}};
  const std::string drawn = svg(plan);
  EXPECT_THAT(drawn, HasSubstr("aria-label=\"lamp &amp; scene\""));
  for (const char* name : {">camera<", ">the scene<", ">lamp today<", ">then<", ">0.2 m<"})
    EXPECT_THAT(drawn, HasSubstr(name));
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0, bar = 0;
  const std::size_t moved = drawn.find("<path class=\"line c1\""), scale = drawn.find("v6h");
  ASSERT_EQ(std::sscanf(drawn.c_str() + drawn.find(" d=\"M", moved), " d=\"M%lf %lfL%lf %lf", &x0, &y0, &x1, &y1), 4);
  ASSERT_EQ(std::sscanf(drawn.c_str() + scale, "v6h%lf", &bar), 1);
  EXPECT_NEAR((x1 - x0) / 0.04, bar / 0.2, 4);
  EXPECT_NEAR((y1 - y0) / 0.1, bar / 0.2, 4);  // nearer is lower
}

TEST(FloorPlan, ShowsThingsThatStandOnOneSpot) {
  const std::string drawn = svg(FloorPlan{"p", {"camera"}, {"c"}, {"a"}, {"b"}});
  EXPECT_THAT(drawn, Not(HasSubstr("nan")));
  EXPECT_THAT(drawn, Not(HasSubstr("inf")));
}

TEST(ColourMap, MeetsItsEnds) {
  EXPECT_EQ(hex(magnitude_colour(0)), "#440154");
  EXPECT_EQ(hex(magnitude_colour(1)), "#fde725");
  EXPECT_EQ(hex(signed_colour(0)), "#f7f7f7");
  EXPECT_EQ(hex(signed_colour(-9)), "#053061");
  EXPECT_EQ(hex(signed_colour(std::nan(""))), "#ff00ff");
}

TEST(NumberText, StopsWhereTheSigmaBegins) {
  EXPECT_EQ(with_sigma(1.02034, 0.00041), "1.0203 \u00b1 0.0004");
  EXPECT_EQ(with_sigma(1.02034, 0.0012), "1.0203 \u00b1 0.0012");
  EXPECT_EQ(with_sigma(-0.5, 0), "\u22120.5000");
  EXPECT_EQ(number_text(std::nan(""), 3), "\u2013");
  EXPECT_EQ(percent_text(0.0027, 2), "0.27 %");
}

}  // namespace
}  // namespace gonio::report
