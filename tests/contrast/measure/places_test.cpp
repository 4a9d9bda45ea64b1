// Where the sample lies when nobody marks its corners: from its outline in rendered photographs, and from a calibration
// board that it lies on.
// One process: Outline.*:BoardPose.*
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/atomic_file.h"
#include "camera/board_drawing.h"
#include "camera/calibrate_document.h"
#include "camera/intrinsics.h"
#include "contrast/measure/measure.h"
#include "contrast/measure/sample_outline.h"
#include "data.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/file_paths.h"
#include "manifest/sections/board.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/pattern.h"
#include "manifest/sections/surface.h"
#include "render/path_tracer.h"
#include "render/ray_caster.h"
#include "render/sensor_chain.h"
#include "render/specimen_matrix.h"
#include "sample_world.h"
#include "scene/scene.h"
#include "stats/distributions.h"

namespace gonio::contrast {
namespace {

struct Photographed {
  tests::ScratchFolder folder;
  tests::SampleWorld world = tests::data_matrix_world("DTU", 0, 21);
  manifest::Document document;
  Photographed() {
    world.tilts_rad = {-0.4, 0.05, 0.3};
    document = tests::photographed(world, folder.path(), false);
    document.patterns["sample"].corners.clear();
  }
};
const Photographed& photographed() {
  static const Photographed instance;
  return instance;
}

GreyView grey_of(const std::filesystem::path& path) {
  const io::Image image = io::read_picture(path);
  GreyView view{image.width, image.height, {}, {}, std::vector<std::uint8_t>(image.pixels()), {}};
  for (std::size_t i = 0; i < image.pixels(); ++i) view.value.push_back(image.data[i * image.channels.size()]);
  return view;
}

// 48 coordinates: their mean square in units of sigma^2 exceeds 1.94 in one of 10^4 such tests. The pattern's bits are
// not stated: the finder of the data matrix numbers the corners.
TEST(Outline, CornersLieWhereTheirSigmasSay) {
  const auto& [folder, world, document] = photographed();
  CellPattern pattern = world.pattern;
  pattern.bits.clear();
  double squares = 0;
  for (int placement = 0; placement < 2; ++placement)
    for (std::size_t k = 0; k < 3; ++k) {
      const GreyView view = grey_of(folder / ((placement == 0 ? "before-" : "after-") + std::to_string(k) + ".exr"));
      const OutlineFound outline = find_outline(view, std::nullopt, pattern.rows);
      ASSERT_TRUE(outline.corners) << outline.problem;
      const OutlineFound numbered = number_corners(view, pattern, true, *outline.corners);
      ASSERT_TRUE(numbered.corners) << numbered.problem;
      for (int corner = 0; corner < 4; ++corner) {
        const auto at = static_cast<std::size_t>(corner);
        const Vec2 error = numbered.corners->pixel[at] - tests::true_corner_px(world, placement, k, corner);
        squares += dot(error, error) / std::pow(numbered.corners->sigma_px[at], 2) / 48;
        EXPECT_LT(numbered.corners->sigma_px[at], 0.2);
      }
    }
  EXPECT_LT(squares, 1.94);
}

// 6 intervals of 99.9 %.
TEST(Outline, ContrastsAreMeasuredWithoutAnyMark) {
  const auto& [folder, world, document] = photographed();
  const Measured m = measure(document, "", {}, {});
  ASSERT_EQ(m.views.size(), 6u);
  for (const MeasuredView& view : m.views) {
    const std::size_t tilt = static_cast<std::size_t>(view.image.back() - '0');
    EXPECT_LT(std::abs(view.michelson.value - tests::true_michelson(world, view.placement, tilt)),
              stats::student_quantile(0.9995, view.degrees) * view.michelson.sigma);
  }
  ASSERT_TRUE(m.code);
  EXPECT_EQ(m.code->text, "DTU");
  EXPECT_EQ(m.code->quarter_turns, 0);
}

// Without poses of the cameras every image is measured through its own outline.
TEST(Outline, ImagesWithoutPosesAreMeasured) {
  manifest::Document document = photographed().document;
  for (manifest::ImageEntry& image : document.images) image.world_from_camera.reset();
  const Measured m = measure(document, "", {}, {});
  EXPECT_EQ(m.views.size(), 6u);
  EXPECT_GT(m.mean_michelson(0).value, 0);
  EXPECT_LT(m.mean_michelson(1).value, 0);
}

struct Sheet {
  camera::Drawing drawing;
  Rigid<frame::World, frame::World> board_from_world;
};

// A ChArUco sheet about the world's origin, beneath z = 0.
Sheet add_sheet(manifest::Document& document, const std::filesystem::path& folder) {
  manifest::Board& section = document.boards["board"];
  section.kind = "charuco";
  section.squares = {7, 5};
  section.square_m = 0.008;
  section.marker_m = 0.006;
  section.dictionary = "4X4_50";
  const camera::Board board = camera::board_of(section, "board");
  Sheet sheet{camera::lay_out(board, "fit", "board"), {}};
  write_file(folder / "board.png", camera::png_of(board, sheet.drawing, 600, "board"));
  document.surfaces["print"].textures["albedo"] = manifest::add_file(document, folder / "board.png", "board");
  document.meshes["sheet"].plane_size_m = {sheet.drawing.width_mm * 1e-3, sheet.drawing.height_mm * 1e-3};
  const Rigid<frame::World, frame::World> world_from_board{
      quaternion_of_rotation_vector({pi, 0, 0}),
      {(sheet.drawing.board_mm.x - sheet.drawing.width_mm / 2) * 1e-3,
       (sheet.drawing.height_mm / 2 - sheet.drawing.board_mm.y) * 1e-3, 0}};
  sheet.board_from_world = inverse(world_from_board);
  return sheet;
}

// Photographs of one placement of the built-in matrix on the sheet, straight into the manifest.
void photograph(const manifest::Document& document, const std::string& placement, const std::filesystem::path& folder,
                std::vector<manifest::ImageEntry>& images) {
  manifest::Document shown = document;
  std::erase_if(shown.objects, [&](const auto& object) { return object.id != placement && object.id != "sheet"; });
  std::erase_if(shown.images, [&](const auto& image) { return image.group != placement; });
  const scene::Scene scene = scene::build_scene(shown);
  const render::RayCaster caster(scene.instances);
  for (std::size_t k = 0; k < shown.images.size(); ++k) {
    manifest::ImageEntry image = shown.images[k];
    const io::Image rendered = render::render(scene, k, caster, {.spp = 4, .seed = 3, .geometry = false});
    io::write_picture(folder / (image.id + ".exr"),
                      render::recorded(rendered, render::sensor_of(shown, k), image.id, 3));
    image.world_from_camera.reset();
    images.push_back(image);
  }
}

// The board gives the cameras' poses, the manifest the sample's on the board: no corner is marked, no robot asked.
TEST(BoardPose, TheSampleIsFoundByTheBoardThatItLiesOn) {
  const tests::ScratchFolder folder;
  manifest::Document document = render::matrix_specimen(folder.path());
  manifest::move_to_folder(document, folder.path());
  const Sheet sheet = add_sheet(document, folder.path());
  const double lift_m = 2e-4, apart_m = document.objects[1].world_from_object->translation_m.x;
  for (manifest::Object& object : document.objects) object.world_from_object->translation_m = {0, 0, lift_m};
  document.objects.push_back({.id = "sheet", .mesh = "sheet", .surface = "print", .world_from_object = {}});
  document.objects.back().world_from_object.emplace();
  std::erase_if(document.images, [](const auto& image) { return image.id.back() == '0' || image.id.back() == '4'; });
  for (manifest::ImageEntry& image : document.images)
    if (image.group == "after") image.world_from_camera->translation_m.x -= apart_m;
  camera::enter_pinhole(document, "camera", 440, 330, 1950);
  std::vector<manifest::ImageEntry> images;
  for (const char* placement : {"before", "after"}) photograph(document, placement, folder.path(), images);
  document.images = images;
  for (manifest::ImageEntry& image : document.images) {
    image.file = manifest::add_file(document, folder / (image.id + ".exr"), image.id);
    image.board = "board";
  }
  document.objects.clear();
  for (std::size_t k = 0; k < 2; ++k) {
    auto& pose = *document.patterns["sample"].placements[k].world_from_pattern;
    pose.translation_m.x -= k == 0 ? 0 : apart_m;
    pose.translation_m.z += lift_m;
    static_cast<Rigid<frame::World, frame::Object>&>(pose) =
        sheet.board_from_world * static_cast<const Rigid<frame::World, frame::Object>&>(pose);
  }
  camera::CalibrationRequest request;
  request.fixed = {"intrinsics", "distortion"};
  request.judge = false;
  camera::calibrate_document(document, request);

  const Measured m = measure(document, "", {}, {});
  ASSERT_EQ(m.views.size(), 6u);
  for (const MeasuredView& view : m.views) {
    EXPECT_LT(norm(view.shift_px), 0.5) << view.image;
    EXPECT_LT(view.place_px, 0.5) << view.image;
  }
  for (const MeasuredView& view : m.views) {  // along the normal the two orientations are clearly told apart
    if (view.image.back() != '2') continue;
    EXPECT_GT(view.michelson.value * (view.placement == 0 ? 1 : -1), 10 * view.michelson.sigma) << view.image;
  }
  EXPECT_EQ(m.turns.size(), 3u);
  ASSERT_TRUE(m.code);
  EXPECT_EQ(m.code->text, "GONIO");
  std::vector<std::size_t> found;
  for (const CellDefect& defect : m.defects.found) found.push_back(defect.cell);
  EXPECT_THAT(found, testing::IsSupersetOf({std::size_t{4 * 12 + 8}, std::size_t{7 * 12 + 3}}));
  EXPECT_LE(found.size(), 3u);  // one sound cell in 20 such sessions, as stated
}

}  // namespace
}  // namespace gonio::contrast
