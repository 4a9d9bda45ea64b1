// pbrt's text: directives and parameters where pbrt wants them, points on their pixels by that program's projections,
// and lamps and media with the manifest's numbers.
#include <algorithm>
#include <cmath>
#include <regex>
#include <set>

#include "exchange_cases.h"
#include "io/exr.h"

namespace gonio::scene {
namespace {

// Tokens of pbrt-v4: words, numbers, quoted strings, brackets. Comments end with the line.
std::vector<std::string> pbrt_tokens(const std::string& text) {
  std::vector<std::string> all;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (std::isspace(static_cast<unsigned char>(c))) {
      ++at;
    } else if (c == '#') {
      at = std::min(text.find('\n', at), text.size());
    } else if (c == '"') {
      std::size_t end = at + 1;
      while (text.at(end) != '"') end += text[end] == '\\' ? 2 : 1;
      all.push_back(text.substr(at, ++end - at));
      at = end;
    } else if (c == '[' || c == ']') {
      all.emplace_back(1, c);
      ++at;
    } else {
      const std::size_t end = std::min(text.find_first_of(" \n\t[]\"#", at), text.size());
      all.push_back(text.substr(at, end - at));
      at = end;
    }
  }
  return all;
}

struct Directive {
  std::string name;
  std::vector<std::string> arguments;                          // strings and numbers before the parameters
  std::map<std::string, std::vector<std::string>> parameters;  // "float fov" -> values
  std::vector<double> numbers(const std::string& key) const {
    std::vector<double> all;
    for (const std::string& v : parameters.at(key)) all.push_back(std::stod(v));
    return all;
  }
};

bool is_parameter(const std::string& token) {
  static const std::regex typed("\"(bool|float|integer|string|rgb|texture|point3|point2) [A-Za-z_.]+\"");
  return std::regex_match(token, typed) || token == "\"point3 P\"";
}

std::vector<Directive> pbrt_directives(const std::string& text) {
  static const std::set<std::string> known = {"Scale",           "LookAt",
                                              "Camera",          "Film",
                                              "PixelFilter",     "Sampler",
                                              "Integrator",      "WorldBegin",
                                              "LightSource",     "AreaLightSource",
                                              "Shape",           "AttributeBegin",
                                              "AttributeEnd",    "Transform",
                                              "Translate",       "NamedMaterial",
                                              "Texture",         "MakeNamedMaterial",
                                              "MakeNamedMedium", "MediumInterface"};
  const auto tokens = pbrt_tokens(text);
  std::vector<Directive> all;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    if (known.contains(tokens[i])) {
      all.push_back({tokens[i], {}, {}});
    } else if (!all.empty() && is_parameter(tokens[i]) && i + 1 < tokens.size() && tokens[i + 1] == "[") {
      auto& values = all.back().parameters[tokens[i].substr(1, tokens[i].size() - 2)];
      EXPECT_TRUE(values.empty()) << tokens[i] << " twice";
      for (i += 2; i < tokens.size() && tokens[i] != "]"; ++i) values.push_back(tokens[i]);
      EXPECT_FALSE(values.empty());
    } else {
      EXPECT_FALSE(all.empty() || std::isupper(static_cast<unsigned char>(tokens[i][0]))) << tokens[i];
      if (!all.empty() && tokens[i] != "[" && tokens[i] != "]") all.back().arguments.push_back(tokens[i]);
    }
  }
  return all;
}

TEST(ExchangePbrt, DirectivesStandWherePbrtWantsThem) {
  const Exported exported = every_look_in("pbrt");
  for (const char* image : {"lamp", "sun", "sky"}) {
    const auto all = pbrt_directives(content_of(exported, std::string(image) + ".pbrt"));
    std::set<std::string> materials, media, textures;
    int depth = 0;
    bool world = false;
    for (const Directive& d : all) {
      if (d.name == "WorldBegin") world = true;
      const bool before = d.name == "Camera" || d.name == "Film" || d.name == "Sampler" || d.name == "Integrator" ||
                          d.name == "PixelFilter" || d.name == "LookAt" || d.name == "Scale";
      EXPECT_EQ(before, !world && d.name != "WorldBegin") << d.name;
      depth += d.name == "AttributeBegin" ? 1 : d.name == "AttributeEnd" ? -1 : 0;
      EXPECT_GE(depth, 0);
      if (d.name == "MakeNamedMaterial") materials.insert(d.arguments.at(0));
      if (d.name == "MakeNamedMedium") media.insert(d.arguments.at(0));
      if (d.name == "NamedMaterial") {
        EXPECT_TRUE(materials.contains(d.arguments.at(0))) << d.arguments.at(0);
      }
      if (d.name == "MediumInterface") {
        EXPECT_TRUE(media.contains(d.arguments.at(0))) << d.arguments.at(0);
      }
      if (d.name == "Transform") {
        EXPECT_EQ(d.arguments.size(), 16u);
      }
      if (const auto file = d.parameters.find("string filename"); file != d.parameters.end() && d.name != "Film")
        content_of(exported, file->second.at(0).substr(1, file->second.at(0).size() - 2));
    }
    EXPECT_EQ(depth, 0);
    EXPECT_TRUE(materials.contains("\"coated wood \\\"&<'\""));
  }
}

// pbrt-v4: LookAt of a left-handed world, screenwindow over the picture, and Scale -1 1 1 before it.
Vec2 pbrt_pixel(const std::vector<Directive>& all, Vec3 p) {
  const auto find = [&](const char* name) {
    return *std::find_if(all.begin(), all.end(), [&](const Directive& d) { return d.name == name; });
  };
  std::vector<double> a;
  for (const std::string& v : find("LookAt").arguments) a.push_back(std::stod(v));
  const Vec3 eye{a[0], a[1], a[2]}, at{a[3], a[4], a[5]}, up{a[6], a[7], a[8]};
  const Vec3 z = normalized(at - eye), x = normalized(cross(normalized(up), z)), y = cross(z, x), arm = p - eye;
  const Vec3 v{-dot(arm, x), dot(arm, y), dot(arm, z)};
  const Directive camera = find("Camera"), film = find("Film");
  const auto window = camera.numbers("float screenwindow");
  const bool orthographic = camera.arguments.at(0) == "\"orthographic\"";
  const double depth = orthographic ? 1 : v.z * std::tan(camera.numbers("float fov")[0] * pi / 360);
  const double width = film.numbers("integer xresolution")[0], height = film.numbers("integer yresolution")[0];
  return {(v.x / depth - window[0]) / (window[1] - window[0]) * width - 0.5,
          (window[3] - v.y / depth) / (window[3] - window[2]) * height - 0.5};
}

TEST(ExchangePbrt, PointsLandOnTheirPixels) {
  for (const double fy : {62.0, 58.5, 70.0}) {
    const Letter letter(fy);
    const Exported exported = letter.exported("pbrt");
    for (const std::size_t i : {0u, 1u}) {
      const auto all = pbrt_directives(content_of(exported, letter.scene.views[i].image + ".pbrt"));
      expect_same_pixels(letter.scene, i, [&](Vec3 p) { return pbrt_pixel(all, p); });
    }
  }
}

TEST(ExchangePbrt, LampsAndMediaHaveTheManifestsNumbers) {
  const Exported exported = every_look_in("pbrt");
  std::map<std::string, std::vector<double>> lamps;
  std::vector<double> radiances;
  for (const Directive& d : pbrt_directives(content_of(exported, "lamp.pbrt"))) {
    if (d.name == "LightSource")
      lamps[d.arguments.at(0)] = d.numbers(d.parameters.contains("rgb I") ? "rgb I" : "rgb L");
    if (d.name == "AreaLightSource") radiances.push_back(d.numbers("rgb L")[0]);
    if (d.name == "MakeNamedMedium" && d.arguments.at(0) == "\"cloud\"") {
      EXPECT_EQ(d.numbers("rgb sigma_s"), (std::vector<double>{10, 20, 40}));
      EXPECT_NEAR(d.numbers("float g")[0], 0.4, 1e-12);
    }
  }
  EXPECT_EQ(lamps.at("\"point\""), (std::vector<double>{2, 2, 1.5}));
  EXPECT_EQ(lamps.at("\"distant\""), (std::vector<double>{6, 2, 0.5}));
  EXPECT_EQ(lamps.at("\"infinite\""), (std::vector<double>{0.2, 0.2, 0.15}));
  std::sort(radiances.begin(), radiances.end());
  ASSERT_EQ(radiances.size(), 3u);
  EXPECT_NEAR(radiances[1], 2 / 0.03, 1e-9);
}

// The white pixel of every direction: Clarberg's map covers the sphere evenly, so its mean is that of the sky.
TEST(ExchangePbrt, SurroundingsKeepTheirMean) {
  const Letter letter;
  const Exported exported = letter.exported("pbrt");
  const io::Image square = io::decode_exr(content_of(exported, "pictures/surroundings-sky-sky.exr"), "sky");
  const light::Emitter& sky = *letter.scene.appearance.lights[letter.scene.views[2].lights.at(0)].emitter;
  Rgb expected, found;
  const int n = 200000;
  for (int i = 0; i < n; ++i) {  // Fibonacci's spiral
    const double z = 1 - (2.0 * i + 1) / n, r = std::sqrt(1 - z * z), phi = i * pi * (3 - std::sqrt(5.0));
    expected += sky.hit({}, {r * std::cos(phi), r * std::sin(phi), z}).radiance / n;
  }
  for (std::size_t i = 0; i < square.pixels(); ++i)
    found += Rgb{square.data[3 * i], square.data[3 * i + 1], square.data[3 * i + 2]} / double(square.pixels());
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c] / expected[c], 1, 0.01);
}

}  // namespace
}  // namespace gonio::scene
