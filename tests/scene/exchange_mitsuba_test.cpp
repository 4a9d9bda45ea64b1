// Mitsuba's XML: well formed, every name defined before it is used, every file there, points on their pixels by the
// projections of that program, and lamps and media with the manifest's numbers.
#include <algorithm>
#include <cmath>
#include <functional>
#include <regex>
#include <set>
#include <sstream>

#include "exchange_cases.h"

namespace gonio::scene {
namespace {

std::vector<double> numbers_in(std::string text) {
  for (char& c : text)
    if (c == ',' || c == '[' || c == ']') c = ' ';
  std::istringstream in(text);
  std::vector<double> all;
  for (double v = 0; in >> v;) all.push_back(v);
  return all;
}

// XML without what Mitsuba's files do not use (comments, CDATA, processing instructions): elements and attributes.
struct Element {
  std::string name;
  std::map<std::string, std::string> attributes;
  std::vector<Element> children;
  const Element* child(const std::string& type, const std::string& label = {}) const {
    for (const Element& e : children)
      if (e.name == type && (label.empty() || (e.attributes.contains("name") && e.attributes.at("name") == label)))
        return &e;
    return nullptr;
  }
  std::vector<double> numbers(const char* type, const char* label) const {
    const Element* e = child(type, label);
    return e ? numbers_in(e->attributes.at("value")) : std::vector<double>{};
  }
  void visit(const std::function<void(const Element&)>& see) const {
    see(*this);
    for (const Element& e : children) e.visit(see);
  }
};

Element parse_element(const std::string& text, std::size_t& at) {
  const auto expect = [&](bool right, const char* what) {
    if (!right) throw std::runtime_error(std::string(what) + " at " + std::to_string(at) + ": " + text.substr(at, 60));
  };
  const auto skip = [&] { at = std::min(text.find_first_not_of(" \n\t", at), text.size()); };
  const auto word = [&] {
    const std::size_t begin = at;
    while (at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) || text[at] == '_')) ++at;
    expect(at > begin, "no name");
    return text.substr(begin, at - begin);
  };
  skip();
  expect(text[at] == '<', "no element");
  ++at;
  Element element;
  element.name = word();
  for (skip(); text[at] != '>' && text[at] != '/'; skip()) {
    const std::string key = word();
    expect(text.compare(at, 2, "=\"") == 0, "no value");
    const std::size_t begin = at += 2;
    at = text.find('"', at);
    expect(at != std::string::npos, "open value");
    const std::string value = text.substr(begin, at++ - begin);
    expect(value.find('<') == std::string::npos, "< in a value");
    expect(!std::regex_search(value, std::regex("&(?!(amp|lt|gt|quot);)")), "bare &");
    expect(element.attributes.emplace(key, value).second, "attribute twice");
  }
  if (text[at] == '/') {
    expect(text[at + 1] == '>', "no end of the element");
    at += 2;
    return element;
  }
  ++at;
  for (skip(); text.compare(at, 2, "</") != 0; skip()) element.children.push_back(parse_element(text, at));
  const std::string closing = "</" + element.name + ">";
  expect(text.compare(at, closing.size(), closing) == 0, "another element ends");
  at += closing.size();
  return element;
}

Element mitsuba_scene(const Exported& exported, const std::string& image) {
  const std::string& text = content_of(exported, image + ".xml");
  std::size_t at = 0;
  Element root = parse_element(text, at);
  EXPECT_EQ(text.find_first_not_of(" \n", at), std::string::npos) << "something after the scene";
  EXPECT_EQ(root.name, "scene");
  return root;
}

TEST(ExchangeMitsuba, EveryNameIsDefinedAndEveryFileThere) {
  const Exported exported = every_look_in("mitsuba");
  for (const char* image : {"lamp", "sun", "sky"}) {
    const Element root = mitsuba_scene(exported, image);
    std::set<std::string> ids, sensors;
    root.visit([&](const Element& e) {
      if (e.attributes.contains("id") && e.name != "ref") {
        EXPECT_TRUE(ids.insert(e.attributes.at("id")).second);
      }
      if (e.name == "ref") {
        EXPECT_TRUE(ids.contains(e.attributes.at("id"))) << e.attributes.at("id");
      }
      if (e.name == "string" && e.attributes.at("name") == "filename") content_of(exported, e.attributes.at("value"));
      if (e.name == "sensor") sensors.insert(e.attributes.at("type"));
    });
    EXPECT_EQ(sensors.size(), 1u);
    EXPECT_EQ(root.child("integrator")->attributes.at("type"), "volpath");
    EXPECT_TRUE(ids.contains("coated wood &quot;&amp;&lt;'"));
  }
}

// Mitsuba 3: perspective_projection() and look_at(); left-handed film, x to the left.
Vec2 mitsuba_pixel(const Element& root, Vec3 p) {
  const Element& sensor = *root.child("sensor");
  const Element& look = *sensor.child("transform")->child("lookat");
  const auto vector = [&](const char* key) {
    const auto v = numbers_in(look.attributes.at(key));
    return Vec3{v[0], v[1], v[2]};
  };
  const Vec3 z = normalized(vector("target") - vector("origin")), x = normalized(cross(vector("up"), z)),
             y = cross(z, x);
  const Vec3 arm = p - vector("origin"), v{dot(arm, x), dot(arm, y), dot(arm, z)};
  const Element& film = *sensor.child("film");
  const double width = film.numbers("integer", "width")[0], height = film.numbers("integer", "height")[0];
  if (sensor.attributes.at("type") == "orthographic") {
    const Element& scale = *sensor.child("transform")->child("scale");
    const double sx = numbers_in(scale.attributes.at("x"))[0], sy = numbers_in(scale.attributes.at("y"))[0];
    return {(0.5 - 0.5 * v.x / sx) * width - 0.5, 0.5 * height - 0.5 * width * v.y / sy - 0.5};
  }
  const double cot = 1 / std::tan(sensor.numbers("float", "fov")[0] * pi / 360);
  const double s = 0.5 - 0.5 * cot * v.x / v.z - sensor.numbers("float", "principal_point_offset_x")[0];
  const double t =
      0.5 - 0.5 * cot * width / height * v.y / v.z - sensor.numbers("float", "principal_point_offset_y")[0];
  return {s * width - 0.5, t * height - 0.5};
}

TEST(ExchangeMitsuba, PointsLandOnTheirPixels) {
  const Letter letter;
  const Exported exported = letter.exported("mitsuba");
  for (const std::size_t i : {0u, 1u})
    expect_same_pixels(letter.scene, i,
                       [&](Vec3 p) { return mitsuba_pixel(mitsuba_scene(exported, letter.scene.views[i].image), p); });
}

TEST(ExchangeMitsuba, LampsAndMediaHaveTheManifestsNumbers) {
  const Exported exported = every_look_in("mitsuba");
  const Element root = mitsuba_scene(exported, "lamp");
  std::map<std::string, const Element*> lamps, media;
  std::vector<double> radiances;
  root.visit([&](const Element& e) {
    if (e.name == "emitter") lamps[e.attributes.at("type")] = &e;
    if (e.name == "emitter" && e.attributes.at("type") == "area") radiances.push_back(e.numbers("rgb", "radiance")[0]);
    if (e.name == "medium") media[e.attributes.at("id")] = &e;
  });
  // The image's gain is [2, 1, 0.5].
  EXPECT_EQ(lamps.at("point")->numbers("rgb", "intensity"), (std::vector<double>{2, 2, 1.5}));
  EXPECT_EQ(lamps.at("directional")->numbers("rgb", "irradiance"), (std::vector<double>{6, 2, 0.5}));
  EXPECT_EQ(lamps.at("constant")->numbers("rgb", "radiance"), (std::vector<double>{0.2, 0.2, 0.15}));
  EXPECT_NEAR(lamps.at("spot")->numbers("float", "cutoff_angle")[0], 0.5 * 180 / pi, 1e-9);
  EXPECT_NEAR(lamps.at("spot")->numbers("float", "beam_width")[0], 0.3 * 180 / pi, 1e-9);
  ASSERT_EQ(radiances.size(), 3u);
  std::sort(radiances.begin(), radiances.end());
  EXPECT_NEAR(radiances[0], 2 / (pi * 0.01), 1e-9);    // disc
  EXPECT_NEAR(radiances[1], 2 / 0.03, 1e-9);           // panel
  EXPECT_NEAR(radiances[2], 2 / (pi * 0.0004), 1e-9);  // ball
  EXPECT_EQ(media.at("glass-inside")->numbers("rgb", "sigma_t"), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(media.at("cloud-inside")->numbers("rgb", "albedo"), (std::vector<double>{1, 1, 1}));
  EXPECT_NEAR(media.at("cloud-inside")->child("phase")->numbers("float", "g")[0], 0.4, 1e-12);
}

}  // namespace
}  // namespace gonio::scene
