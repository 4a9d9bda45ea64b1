// Every parameter of every registered surface, stated per vertex, per face label, by a texture and by a law: the
// picture is the one of the same value stated once. Parameters of what is inside an object may not vary, and are
// refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "data.h"
#include "io/merl.h"
#include "io/picture.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "render/scenes.h"
#include "surface/merl_tables.h"

namespace gonio::tests {
namespace {

constexpr int size_px = 10;

// A cube with its own vertices at every face: faces have the labels 0 and 1 in turn.
io::TriangleMesh cube(double amount) {
  io::TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
      for (const auto& [s, t] : {std::pair{-1, -1}, std::pair{1, -1}, std::pair{1, 1}, std::pair{-1, 1}}) {
        const double p[3] = {side, s * side, static_cast<double>(t)};  // counter-clockwise from outside
        mesh.positions_m.push_back(Vec3{p[(3 - axis) % 3], p[(4 - axis) % 3], p[(5 - axis) % 3]} * 0.5);
        mesh.texture.push_back({(s + 1) / 2.0, (t + 1) / 2.0});
      }
      for (const auto& t : {std::array{0u, 1u, 2u}, std::array{0u, 2u, 3u}}) {
        mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
        mesh.labels.push_back(side > 0 ? axis % 2 : 1 - axis % 2);
      }
    }
  mesh.properties = {std::vector<float>(mesh.positions_m.size(), static_cast<float>(amount))};
  return mesh;
}

std::string digits(double v) {
  std::ostringstream text;
  text.precision(17);
  text << v;
  return text.str();
}

// Somewhere within the bounds, and somewhere else; single precision, as files hold it.
double usual(const manifest::ParameterInfo& info) {
  const double v = info.preset.value_or(info.lower + 0.25 * (info.upper - info.lower));
  return static_cast<double>(static_cast<float>(v));
}
double unusual(const manifest::ParameterInfo& info) {
  const double v = usual(info),
               room = info.upper - v > 0.1 * (info.upper - info.lower) ? info.upper - v : info.lower - v;
  return static_cast<double>(static_cast<float>(v + 0.3 * room));
}

struct Stage {
  explicit Stage(const surface::Model& shown) : model(shown) {
    if (model.info().attachment == manifest::Attachment::table)
      io::write_merl(folder / "t.binary", varnish_table({16, 12, 16}, 0.3));
  }
  // `special` states the parameter `name`, or is empty.
  scene::Scene scene(const std::string& name, double amount, const std::string& special) const {
    io::write_ply(folder / "m.ply", cube(amount), {.properties = {"wear"}});
    io::Image flat(2, 2, {"R", "G", "B"});
    std::fill(flat.data.begin(), flat.data.end(), static_cast<float>(amount));
    io::write_picture(folder / "t.exr", flat);
    std::string entry = R"({"model": ")" + model.info().id + '"';
    for (const auto& p : model.info().parameters)
      if (p.name != name) entry += ", \"" + p.name + "\": " + digits(usual(p));
    if (model.info().attachment != manifest::Attachment::none) entry += R"(, "file": "table")";
    if (model.info().takes_base) entry += R"(, "base": "under")";
    entry += ", " + (special.empty() ? '"' + name + "\": " + digits(amount) : special) + "}";
    const std::string text =
        R"({"gonio": 1, "files": {"m": {"path": "m.ply"}, "t": {"path": "t.exr"}, "table": {"path": "t.binary"}},
          "meshes": {"cube": {"file": "m", "normals": "flat"}},
          "surfaces": {"s": )" +
        entry + R"(, "under": {"model": "diffuse", "albedo": 0.6}},
          "lights": {"l": {"model": "point", "position_m": [1, 2, 3], "watt_per_sr": 3},
                     "sky": {"model": "uniform", "radiance": 0.2}},
          "objects": [{"id": "o", "mesh": "cube", "surface": "s"}]})";
    scene::Scene built = scene::build_scene(manifest::parse_document(text, "s.json", folder.path()));
    built.instances[0].world_from_object = {quaternion_of_rotation_vector({0.7, 0.5, 0.2}), {}};
    built.views.push_back({"view",
                           camera::CameraModel::parallel(size_px / 1.8, size_px, size_px),
                           {quaternion_of_rotation_vector({pi, 0, 0}), {0, 0, 5}},
                           {0, 1},
                           {1, 1, 1},
                           {},
                           "camera"});
    return built;
  }
  io::Image picture(const std::string& name, double amount, const std::string& special = "") const {
    return render_view(scene(name, amount, special), {.spp = 8, .seed = 3, .geometry = false});
  }
  // Light passes inside from one face to another.
  bool hollow() const {
    const manifest::ParameterInfo& first = model.info().parameters.front();
    const scene::Scene built = scene(first.name, usual(first), "");
    return model.transmits() || model.subsurface(built.appearance.surfaces[0].values);
  }
  const surface::Model& model;
  ScratchFolder folder;
};

double difference(const io::Image& a, const io::Image& b, int x, int y) {
  double most = 0;
  for (const char* name : {"R", "G", "B"}) {
    const int c = a.channel(name);
    const double scale = std::abs(a.at(x, y, c)) + std::abs(b.at(x, y, c)) + 1e-3;
    most = std::max(most, std::abs(static_cast<double>(a.at(x, y, c)) - static_cast<double>(b.at(x, y, c))) / scale);
  }
  return most;
}

class EveryParameter : public testing::TestWithParam<const surface::Model*> {};
INSTANTIATE_TEST_SUITE_P(Registered, EveryParameter,
                         testing::ValuesIn(surface::all_models().begin(), surface::all_models().end()),
                         [](const testing::TestParamInfo<const surface::Model*>& info) {
                           std::string name = info.param->info().id;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// Tables that serve uniform values may differ by 2e-3 from what is computed on the spot. Light beneath a surface is
// normalised by what one roughness lets pass, that of the whole surface: 0.02.
void expect_same(const io::Image& plain, const io::Image& varied, bool hollow, const std::string& what) {
  double worst = 0;
  for (int y = 0; y < size_px; ++y)
    for (int x = 0; x < size_px; ++x) worst = std::max(worst, difference(plain, varied, x, y));
  EXPECT_LE(worst, hollow ? 0.02 : 2e-3) << what;
}

TEST_P(EveryParameter, MayVaryOrIsRefused) {
  const Stage stage(*GetParam());
  const bool hollow = stage.hollow();
  for (const auto& info : GetParam()->info().parameters) {
    const std::string& p = info.name;
    const double amount = unusual(info), governed = std::clamp(amount, 0.0, 1.0);
    const std::string v = digits(governed);
    const std::string per_vertex = R"("vertices": {")" + p + R"(": "wear"})";
    try {
      stage.scene(p, amount, per_vertex);
    } catch (const Error& error) {
      EXPECT_TRUE(hollow) << error.what();
      EXPECT_THAT(error.what(), testing::HasSubstr("s.json#/surfaces/s: " + p + " belongs to the inside of an object"));
      continue;
    }
    const io::Image plain = stage.picture(p, amount);
    const auto varied = [&](const std::string& special) { return stage.picture(p, amount, special); };
    expect_same(plain, varied(per_vertex), hollow, p + " per vertex");
    expect_same(plain, varied(R"("textures": {")" + p + R"(": "t"})"), hollow, p + " by a texture");
    const std::string entry = digits(amount);
    expect_same(plain, varied(R"("labels": {")" + p + R"(": {"0": )" + entry + R"(, "1": )" + entry + "}}"), hollow,
                p + " per label");
    if (info.components == 3) continue;
    expect_same(stage.picture(p, std::clamp(governed, info.lower, info.upper)),
                varied(R"("laws": {")" + p + R"(": {"law": "print-layers", "layer_m": 0.1, "alpha_even": )" + v +
                       R"(, "alpha_odd": )" + v + "}}"),
                hollow, p + " by a law");
  }
}

// Each face shows its own value: pixels are those of the one or of the other uniform picture.
TEST_P(EveryParameter, IsThatOfTheFaceThatIsSeen) {
  const Stage stage(*GetParam());
  if (stage.hollow()) return;
  for (const auto& info : GetParam()->info().parameters) {
    const double a = usual(info), b = unusual(info);
    const io::Image one = stage.picture(info.name, a), other = stage.picture(info.name, b);
    const io::Image both = stage.picture(
        info.name, a, R"("labels": {")" + info.name + R"(": {"0": )" + digits(a) + R"(, "1": )" + digits(b) + "}}");
    int of_one = 0, of_other = 0, alike = 0;
    for (int y = 0; y < size_px; ++y)
      for (int x = 0; x < size_px; ++x) {
        const bool is_one = difference(both, one, x, y) < 2e-3, is_other = difference(both, other, x, y) < 2e-3;
        of_one += is_one && !is_other;
        of_other += is_other && !is_one;
        alike += is_one && is_other;
      }
    EXPECT_GE(of_one + of_other + alike, size_px * size_px * 3 / 4) << info.name;  // others see an edge
    EXPECT_TRUE((of_one > 3 && of_other > 3) || alike > 90) << info.name << " " << of_one << " " << of_other;
  }
}

}  // namespace
}  // namespace gonio::tests
