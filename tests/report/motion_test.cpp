// Views of points that move: what is stored of them, the drawing that stays without the script, and the script in a
// browser, where one is installed: it draws, plays and turns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <regex>

#include "data.h"
#include "process.h"
#include "report/page.h"
#include "report/point_motion.h"

namespace gonio::report {
namespace {

using testing::HasSubstr;

// A bar of four points that goes round, found a tenth too far out; one point was not found in the last frame.
PointMotion turning_bar() {
  PointMotion m;
  m.name = "bar <1>", m.unit = "mm", m.points = 4, m.links = {{0, 1}, {1, 2}, {2, 3}};
  for (int f = 0; f < 5; ++f) {
    m.frames.push_back(10 * f);
    for (int p = 0; p < 4; ++p) {
      const double a = 0.3 * f, r = p - 1.5;
      for (const double factor : {1.0, 1.1}) {
        auto& set = factor > 1 ? m.found : m.truth;
        for (const double v : {r * std::cos(a), r * std::sin(a), 0.2 * p}) set.push_back(float(factor * v));
      }
    }
  }
  m.found.back() = std::numeric_limits<float>::quiet_NaN();
  return m;
}

std::string attribute(const std::string& html, const std::string& name) {
  const std::size_t from = html.find("data-" + name + "=\"") + name.size() + 7;
  return html.substr(from, html.find('"', from) - from);
}

TEST(PointMotion, StoresPointsToHalfAStep) {
  const PointMotion m = turning_bar();
  const std::string text = html(m), codes = attribute(text, "codes");
  ASSERT_EQ(codes.size(), 2 * (m.truth.size() + m.found.size()));
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  double origin[3];
  ASSERT_EQ(std::sscanf(attribute(text, "origin").c_str(), "%lf %lf %lf", origin, origin + 1, origin + 2), 3);
  const double step = std::stod(attribute(text, "step"));
  EXPECT_LT(step, 2 * 3.0 / 4000);
  std::size_t at = 0;
  for (std::size_t f = 0; f < 5; ++f)
    for (const auto* set : {&m.truth, &m.found})
      for (std::size_t i = 12 * f; i < 12 * (f + 1); ++i, at += 2) {
        const auto code = 64 * digits.find(codes[at]) + digits.find(codes[at + 1]);
        if (std::isnan((*set)[i]))
          EXPECT_EQ(code, 4095);
        else
          EXPECT_NEAR(origin[i % 3] + step * double(code), (*set)[i], 0.5 * step + 1e-7);
      }
}

// What was found beyond the cube about the truth stands at its border, on the side where it is.
TEST(PointMotion, FarPointsStandAtTheBorder) {
  PointMotion m = turning_bar();
  m.found[0] = 1e30f, m.found[1] = -1e30f;
  const std::string codes = attribute(html(m), "codes");
  EXPECT_EQ(codes.substr(24, 4), "/+AA");  // 4094 and 0, after 12 coordinates of the truth
}

TEST(PointMotion, StaysADrawingWithoutTheScriptAndIsEscaped) {
  const std::string text = html(turning_bar());
  EXPECT_THAT(text, HasSubstr("<svg viewBox"));
  EXPECT_THAT(text, HasSubstr("bar &lt;1&gt;"));
  EXPECT_EQ(text.find("nan"), std::string::npos);
  std::size_t circles = 0;
  for (std::size_t at = text.find("<circle"); at != std::string::npos; at = text.find("<circle", at + 1)) ++circles;
  EXPECT_EQ(circles, 8);
  PointMotion nothing;
  EXPECT_THAT(html(nothing), HasSubstr("<svg"));
}

TEST(PointMotion, FirstTurnIsARotationThatShowsTheLongestExtent) {
  PointMotion m = turning_bar();
  m.frames.resize(1), m.truth.resize(12), m.found.resize(12);
  const auto t = turn_for(m);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) sum += t[3 * i + k] * t[3 * j + k];
      EXPECT_NEAR(sum, i == j ? 1 : 0, 1e-12);
    }
  const double cross =
      t[0] * (t[4] * t[8] - t[5] * t[7]) - t[1] * (t[3] * t[8] - t[5] * t[6]) + t[2] * (t[3] * t[7] - t[4] * t[6]);
  EXPECT_NEAR(cross, 1, 1e-12);
  const double dx = m.truth[9] - m.truth[0], dy = m.truth[10] - m.truth[1], dz = m.truth[11] - m.truth[2];
  EXPECT_GT(std::abs(t[0] * dx + t[1] * dy + t[2] * dz), 0.85 * std::sqrt(dx * dx + dy * dy + dz * dz));
}

TEST(PointMotion, PagesWithoutOneCarryNothingOfIt) {
  Page page("t", "h", "");
  EXPECT_EQ(page.html().find(".motion"), std::string::npos);
  page.figures({{.svg = html(turning_bar()), .title = "bar"}});
  EXPECT_NE(page.html().find(".motion canvas"), std::string::npos);
}

TEST(PointMotion, InABrowserDrawsScrubsPlaysAndTurns) {
  const char* browser = "/usr/bin/chromium";
  if (!std::filesystem::exists(browser)) GTEST_SKIP() << "no Chromium";
  PointMotion m = turning_bar();
  m.turn = turn_for(m);
  Page page("t", "h", "");
  page.figures({{.svg = html(m), .title = "bar"}});
  std::string text = page.html();
  const std::string probe = R"(<script>
    const box = document.querySelector('.motion'), c = box.querySelector('canvas'), r = box.querySelector('input');
    const sum = () => c.getContext('2d').getImageData(0, 0, c.width, c.height).data.reduce((a, b) => a + b, 0);
    const says = [], note = () => says.push(box.dataset.drawn + ':' + sum());
    note(); r.value = 4; r.dispatchEvent(new Event('input')); note();
    c.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowUp'})); note();
    document.body.dataset.says = says.join(' ');
    document.body.dataset.output = box.querySelector('output').value;
    let picture = null;  // pictures come by hand, every 100 ms of a clock that no machine slows down
    window.requestAnimationFrame = f => { picture = f; };
    box.querySelector('button').click();
    const played = [];
    for (let k = 1; k <= 3; ++k) { picture(1e6 + 100 * k); played.push(box.dataset.drawn); }
    document.body.dataset.played = played.join(' ');
    </script></body>)";
  text.replace(text.find("</body>"), 7, probe);
  const tests::ScratchFolder folder;
  std::ofstream(folder / "page.html") << text;
  tests::Process chromium({browser, "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                           "--disable-background-networking", "--disable-component-update", "--disable-sync",
                           "--user-data-dir=" + (folder / "profile").string(), "--virtual-time-budget=3000",
                           "--dump-dom", "file://" + (folder / "page.html").string()});
  const tests::Ended ended = chromium.end();
  ASSERT_EQ(ended.status, 0) << ended.err;
  std::smatch says;
  const std::regex pattern("data-says=\"20:(\\d+) 40:(\\d+) 40:(\\d+)\"");
  ASSERT_TRUE(std::regex_search(ended.out, says, pattern)) << ended.out.substr(ended.out.size() - 600);
  EXPECT_GT(std::stoll(says[1]), 1000);  // something is drawn
  EXPECT_NE(says[1], says[2]);
  EXPECT_NE(says[2], says[3]);
  // The last frame: distances 0.1 |p - truth's| of three points.
  double squares = 0;
  for (std::size_t i = 48; i < 57; ++i) squares += std::pow(m.found[i] - m.truth[i], 2);
  std::smatch rms;
  ASSERT_TRUE(std::regex_search(ended.out, rms, std::regex("data-output=\"frame 40: root mean square ([0-9.]+) mm\"")));
  EXPECT_NEAR(std::stod(rms[1]), std::sqrt(squares / 3), 1e-3);
  EXPECT_THAT(ended.out, HasSubstr("data-played=\"0 10 20\""));  // from the last frame on
}

}  // namespace
}  // namespace gonio::report
