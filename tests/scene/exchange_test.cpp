// What every exchange format keeps: repeatable files, losses named, cameras that see the same points.
#include <set>

#include "base/error.h"
#include "exchange_cases.h"
#include "manifest/image_list.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/object.h"
#include "manifest/value.h"

namespace gonio::scene {
namespace {

using testing::Contains;
using testing::Field;
using testing::HasSubstr;

TEST(Exchange, EveryFormatIsRepeatable) {
  const Letter letter;
  for (const Exchange* format : all_exchanges()) {
    const Exported one = export_scene(letter.scene, *format), two = export_scene(letter.scene, *format);
    ASSERT_FALSE(one.files.empty()) << format->name();
    ASSERT_EQ(one.files.size(), two.files.size()) << format->name();
    std::set<std::string> names;
    for (std::size_t i = 0; i < one.files.size(); ++i) {
      EXPECT_EQ(one.files[i].name, two.files[i].name);
      EXPECT_EQ(one.files[i].content, two.files[i].content) << one.files[i].name;
      EXPECT_TRUE(names.insert(one.files[i].name).second) << one.files[i].name << " twice";
    }
  }
}

TEST(Exchange, LossesPointIntoTheManifestAndSayWhatIsShownInstead) {
  Letter letter;
  manifest::Document document = letter.document;
  bend_lens(document);
  document.mechanisms["optics.vignetting"].parameters["falloff"] = 0.1;
  document.mechanisms["transport.indirect"].parameters["strength"] = 0.5;
  const Scene scene = build_scene(document);
  for (const Exchange* format : all_exchanges()) {
    const Exported exported = export_scene(scene, *format);
    for (const char* pointer :
         {"/cameras/c", "/mechanisms/optics.vignetting", "/mechanisms/transport.indirect", "/surfaces/glaze"})
      EXPECT_THAT(exported.losses, Contains(Field(&Loss::pointer, pointer))) << format->name();
    for (const Loss& loss : exported.losses) {
      EXPECT_FALSE(loss.what.empty());
      EXPECT_FALSE(loss.instead.empty());
      EXPECT_TRUE(loss.pointer.starts_with("/")) << loss.pointer;
    }
  }
}

TEST(Exchange, FormatsAreFoundByName) {
  EXPECT_EQ(find_exchange("blender")->name(), "blender");
  EXPECT_EQ(find_exchange("povray"), nullptr);
  try {
    importer_of("scene.max");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::usage);
    EXPECT_THAT(error.what(), HasSubstr("scene.max"));
  }
}

manifest::Value blender_numbers(const Exported& exported) {
  const std::string& script = content_of(exported, "scene.py");
  const std::size_t first = script.find("r'''") + 4;
  return manifest::parse_json(script.substr(first, script.find("'''", first) - first), "scene.py");
}

// BKE_camera_params_compute_viewplane with sensor_fit horizontal, at clip distance 1: x from -w/2 to w/2, y from
// -ycor h/2 to ycor h/2, both moved by shift times w, all times sensor / (lens w); orthographic: ortho_scale / w.
Vec2 blender_pixel(const manifest::Value& c, Vec3 p) {
  const auto number = [&](const char* key) { return c.find(key)->as_number(); };
  const auto item = [&](const char* key, std::size_t i) { return c.find(key)->as_array().at(i).as_number(); };
  const Quaternion q{item("rotation", 0), item("rotation", 1), item("rotation", 2), item("rotation", 3)};
  const Vec3 v = transposed(matrix_of(q)) * (p - Vec3{item("location", 0), item("location", 1), item("location", 2)});
  EXPECT_LT(v.z, 0);
  const double width = item("resolution", 0), height = item("resolution", 1);
  const double ycor = item("pixel_aspect", 1) / item("pixel_aspect", 0);
  const bool orthographic = c.find("orthographic")->as_bool();
  const double pixel =
      orthographic ? number("ortho_scale") / width : number("sensor_width_mm") / number("lens_mm") / width;
  const double depth = orthographic ? 1 : -v.z;
  const double x = v.x / depth / pixel + 0.5 * width - item("shift", 0) * width;
  const double y = (v.y / depth / pixel + 0.5 * ycor * height - item("shift", 1) * width) / ycor;
  return {x - 0.5, height - y - 0.5};
}

TEST(ExchangeBlender, PointsLandOnTheirPixels) {
  for (const double fy : {62.0, 58.5, 70.0}) {
    const Letter letter(fy);
    const manifest::Value numbers = blender_numbers(letter.exported("blender"));
    for (const std::size_t i : {0u, 1u})
      expect_same_pixels(letter.scene, i, [&](Vec3 p) {
        return blender_pixel(*numbers.find("images")->as_array().at(i).find("camera"), p);
      });
  }
}

TEST(ExchangeBlender, NamesWithQuotesStayNames) {
  manifest::Document document = Letter().document;
  document.objects.resize(1);
  document.objects[0].id = "the ''' potter's \"bowl\\";
  document.lights.erase("sky");
  keep_images(document, {"lamp"});
  const Exported exported = export_scene(build_scene(document), *find_exchange("blender"));
  const manifest::Value numbers = blender_numbers(exported);
  EXPECT_EQ(numbers.find("objects")->as_array().at(0).find("id")->as_string(), document.objects[0].id);
}

}  // namespace
}  // namespace gonio::scene
