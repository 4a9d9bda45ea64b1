// The report in a real browser, where one is installed: the script runs, nothing is fetched, and the divider moves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>

#include "data.h"
#include "io/picture.h"
#include "report/page.h"
#include "process.h"

namespace gonio::report {
namespace {

using testing::HasSubstr;

std::string browser() {
  for (const char* path : {"/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"})
    if (std::filesystem::exists(path)) return path;
  return {};
}

std::string flat_png(float grey) {
  io::Image image(8, 8, {"R", "G", "B"});
  std::fill(image.data.begin(), image.data.end(), grey);
  return io::encode_png(image);
}

TEST(PageInABrowser, RunsItsScriptAndMovesTheDivider) {
  if (browser().empty()) GTEST_SKIP() << "no Chromium";
  Page page("Test", "Two grey squares", "");
  page.section("Pair");
  page.slider({.png = flat_png(0.2f), .title = "Dark"}, {.png = flat_png(0.8f), .title = "Bright"}, "drag");
  page.plot({.title = "p", .series = {{.x = {1, 2}, .y = {3, 4}}}});
  std::string html = page.html();
  const std::string probe =
      "<script>const r=document.querySelector('.pair-frame input');r.value=250;"
      "r.dispatchEvent(new Event('input'));document.body.dataset.loaded="
      "[...document.images].filter(i=>i.complete&&i.naturalWidth===8).length;</script></body>";
  html.replace(html.find("</body>"), 7, probe);
  const tests::ScratchFolder folder;
  std::ofstream(folder / "page.html") << html;
  tests::Process chromium({browser(), "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                           "--disable-background-networking", "--disable-component-update", "--disable-sync",
                           "--user-data-dir=" + (folder / "profile").string(), "--virtual-time-budget=2000",
                           "--dump-dom", "file://" + (folder / "page.html").string()});
  const tests::Ended ended = chromium.end();
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("data-ready=\"1 pairs\""));
  EXPECT_THAT(ended.out, HasSubstr("--cut: 25%"));
  EXPECT_THAT(ended.out, HasSubstr("aria-valuetext=\"25 % Dark\""));
  EXPECT_THAT(ended.out, HasSubstr("data-loaded=\"2\""));
  const std::regex reference("(src|href)=\"([^\"]{1,8})");
  for (std::sregex_iterator at(ended.out.begin(), ended.out.end(), reference), end; at != end; ++at)
    EXPECT_TRUE((*at)[2].str().starts_with("data:") || (*at)[2].str().starts_with("#")) << (*at)[0];
}

}  // namespace
}  // namespace gonio::report
