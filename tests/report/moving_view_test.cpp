// A model that moves, in the view of surfaces: what is stored, the still picture at the time asked for, and in a real
// browser, where one is installed, that the script puts every node where io::placed_nodes has it, draws, and keeps
// plots and words with the time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "base/random.h"
#include "base/text.h"
#include "data.h"
#include "io/raster.h"
#include "manifest/value.h"
#include "process.h"
#include "report/mesh_view.h"
#include "report/page.h"

namespace gonio::report {
namespace {

using testing::HasSubstr;

io::TriangleMesh tetrahedron(double size) {
  io::TriangleMesh mesh;
  mesh.positions_m = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

// A chain of three hinges on a stand, the last node turning red at 2 s.
io::MovingModel chain() {
  io::MovingModel model;
  model.meshes = {tetrahedron(0.1), tetrahedron(0.3)};
  model.palette = {{0.2f, 0.4f, 0.6f}, {0.9f, 0.1f, 0.1f}};
  Random random(3, 9);
  const auto any = [&random] {
    return Rigid<frame::Object, frame::Object>{
        quaternion_of_rotation_vector({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}),
        {random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), random.uniform(0, 0.4)}};
  };
  model.nodes.push_back({.name = "stand", .placed = any(), .mesh = 1, .label = "<stand>"});
  for (int k = 0; k < 3; ++k)
    model.nodes.push_back({.name = "link", .parent = k, .placed = any(), .hinge = k, .mesh = 0});
  model.nodes.back().changes = {{2, 1}};
  model.keys = {{0, {0, 0, 0}}, {1.5, {1, -2, 0.5}}, {4, {-1, 3, 9}}};
  model.words = {{0, "goes"}, {1.5, "stands </script>", true}};
  return model;
}

MeshView view_of_chain() {
  MeshView view{.name = "chain", .meshes = {}, .label = "", .unit = ""};
  view.moving = chain();
  view.legend = {{1, "late"}};
  return view;
}

TEST(MovingView, AnglesRunInProportionBetweenKeysAndStayBeyond) {
  const io::MovingModel model = chain();
  EXPECT_EQ(io::angles_at(model, -1), (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(io::angles_at(model, 0.75), (std::vector<double>{0.5, -1, 0.25}));
  EXPECT_EQ(io::angles_at(model, 99), (std::vector<double>{-1, 3, 9}));
  EXPECT_EQ(io::colour_at(model.nodes.back(), 1.9), 0);
  EXPECT_EQ(io::colour_at(model.nodes.back(), 2), 1);
  EXPECT_TRUE(io::angles_at({}, 0).empty());
}

TEST(MovingView, TheStillShowsTheTimeThatIsAskedFor) {
  MeshView view = view_of_chain();
  const auto reds = [&view] {
    const io::Image seen = io::decode_raster(still_png(view, 0, 80, 60), "still");
    int count = 0;
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 80; ++x) count += seen.at(x, y, 0) > seen.at(x, y, 2) + 0.1f;
    return count;
  };
  EXPECT_EQ(reds(), 0);
  view.start_s = 3;
  EXPECT_GT(reds(), 5);
}

TEST(MovingView, NothingThatIsNamedEndsTheDataEarly) {
  const std::string html = report::html(view_of_chain());
  EXPECT_EQ(html.find("stands </script>"), std::string::npos);
  EXPECT_THAT(html, HasSubstr("stands \\u003c/script>"));
  EXPECT_THAT(html, HasSubstr("late"));
  Page with("t", "h", ""), without("t", "h", "");
  with.figures({{.svg = html}});
  without.plot({.title = "p", .series = {{.x = {1, 2}, .y = {3, 4}}}});
  EXPECT_THAT(with.html(), HasSubstr("makeTimeline"));
  EXPECT_THAT(without.html(), testing::Not(HasSubstr("makeTimeline")));
  EXPECT_THAT(without.html(), testing::Not(HasSubstr("data-time")));
}

std::string chromium_path() {
  for (const char* path : {"/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"})
    if (std::filesystem::exists(path)) return path;
  return {};
}

// The page's last words: an attribute of the body that the probe fills.
std::string probed(const std::string& dom, const std::string& name) {
  const std::string key = "data-" + name + "=\"";
  const std::size_t at = dom.find(key);
  return at == std::string::npos ? "" : dom.substr(at + key.size(), dom.find('"', at + key.size()) - at - key.size());
}

// What the browser is asked: where nodes stand at seven times, what keys do, what is drawn.
const std::string browser_probe = R"js(<script>const b=document.querySelector('.solid'),body=document.body.dataset;
    body.webgl=b.model?'yes':'no';
    if(b.model){
      const places=[];
      for(const t of [-1,0,0.7,1.5,2.2,3.9,9])for(const n of b.model.place(t))places.push(...n.o,...n.q);
      body.places=places.join(' ');
      const press=(key,on)=>(on||b.querySelector('canvas')).dispatchEvent(
        new KeyboardEvent('keydown',{key,bubbles:true}));
      press('PageDown');body.stop=b.dataset.time+' '+b.querySelector('output').value;
      body.cursor=document.querySelector('.cursor').getAttribute('d');
      press('End',b.querySelector('input[type=range]'));body.end=b.dataset.time;
      body.colour=b.model.colourAt(b.model.nodes[3],3).map(v=>v.toFixed(1)).join(' ');
      press(' ');body.playing=b.querySelector('.controls button').textContent;
      press(' ');body.paused=b.querySelector('.controls button').textContent;
      press('Home',b.querySelector('input[type=range]'));
      const g=b.querySelector('canvas').getContext('webgl'),w=g.drawingBufferWidth,h=g.drawingBufferHeight;
      const seen=new Uint8Array(4*w*h);g.readPixels(0,0,w,h,g.RGBA,g.UNSIGNED_BYTE,seen);
      let drawn=0;for(let i=0;i<seen.length;i+=4)drawn+=seen[i+2]>seen[i]+20;
      body.drawn=(drawn/w/h).toFixed(4);
      body.tag=b.querySelector('.names span').textContent;
    }</script></body>)js";

TEST(MovingView, TheScriptMovesTheModelAsTheLibraryDoes) {
  if (chromium_path().empty()) GTEST_SKIP() << "no Chromium";
  Page page("Test", "A chain", "");
  page.figures({{.svg = html(view_of_chain())}});
  page.plot({.title = "p", .series = {{.x = {0, 4}, .y = {3, 4}}}, .over_time = true, .x_range = {0, 4}});
  std::string text = page.html();
  text.replace(text.find("</body>"), 7, browser_probe);
  const tests::ScratchFolder folder;
  std::ofstream(folder / "page.html") << text;
  tests::Process chromium({chromium_path(), "--headless", "--no-sandbox", "--enable-unsafe-swiftshader",
                           "--use-angle=swiftshader", "--disable-quic", "--no-first-run",
                           "--disable-background-networking", "--disable-component-update", "--disable-sync",
                           "--user-data-dir=" + (folder / "profile").string(), "--virtual-time-budget=2000",
                           "--dump-dom", "file://" + (folder / "page.html").string()});
  const tests::Ended ended = chromium.end();
  ASSERT_EQ(ended.status, 0) << ended.err;
  if (probed(ended.out, "webgl") != "yes") GTEST_SKIP() << "no WebGL: " << ended.err;
  std::istringstream places(probed(ended.out, "places"));
  const io::MovingModel model = chain();
  double worst = 0;
  for (const double t : {-1.0, 0.0, 0.7, 1.5, 2.2, 3.9, 9.0})
    for (const io::PlacedNode& node : io::placed_nodes(model, t)) {
      for (int k = 0; k < 3; ++k) {
        double v = NAN;
        places >> v;
        worst = std::max(worst, std::abs(v - node.origin_m[k]));
      }
      for (const double m : node.rotation.m) {
        double v = NAN;
        places >> v;
        worst = std::max(worst, std::abs(v - m));
      }
    }
  EXPECT_TRUE(places.good() || places.eof());
  EXPECT_LT(worst, 1e-6);
  EXPECT_THAT(probed(ended.out, "stop"), HasSubstr("1.500 1.5 s of 4.0 s: stands "));
  const double left = 58, right = 560 - 16;
  EXPECT_THAT(probed(ended.out, "cursor"), testing::StartsWith(format("M%.2f ", left + (right - left) * 1.5 / 4)));
  EXPECT_EQ(probed(ended.out, "end"), "4.000");
  EXPECT_EQ(probed(ended.out, "colour"), "0.9 0.1 0.1");
  EXPECT_EQ(probed(ended.out, "playing"), "Pause");
  EXPECT_EQ(probed(ended.out, "paused"), "Play");
  EXPECT_GT(std::stod(probed(ended.out, "drawn")), 0.01);
  EXPECT_EQ(probed(ended.out, "tag"), "&lt;stand&gt;");
}

}  // namespace
}  // namespace gonio::report
