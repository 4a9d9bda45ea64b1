// Exports for programs that know lenses: the files are parsed as those programs parse them and points are projected by
// OpenCV itself, or by COLMAP's formulas written from its documentation.
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <sstream>

#include "export_cases.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"

namespace gonio::camera {
namespace {

using Terms = std::vector<std::pair<const char*, double>>;

manifest::Document document_with(const std::string& model, const Terms& terms) {
  manifest::Document document = exported_document(false);
  for (auto& [name, camera] : document.cameras) {
    camera.model = model;
    for (const auto& [term, value] : terms) camera.distortion[term] = value;
  }
  return document;
}

struct Lens {
  std::string model;
  Terms terms;
};

const Terms brown = {{"k1", -0.281}, {"k2", 0.025}, {"p1", 0.0031}, {"p2", -0.0021}, {"k3", 0.163}};
const Terms rational = {{"k1", -0.281}, {"k2", 0.025}, {"p1", 0.0031}, {"p2", -0.0021},
                        {"k3", 0.163},  {"k4", 0.05},  {"k5", -0.03},  {"k6", 0.01}};
const Terms fisheye = {{"k1", -0.021}, {"k2", 0.012}, {"k3", -0.004}, {"k4", 0.0011}};

std::vector<Lens> lenses_of_opencv() {
  Terms prism = brown;
  for (const auto& term : Terms{{"s1", 0.004}, {"s2", -0.001}, {"s3", 0.002}, {"s4", 0.0005}}) prism.push_back(term);
  return {{"pinhole", {}},
          {"radial-tangential", brown},
          {"thin-prism", prism},
          {"rational", rational},
          {"fisheye", fisheye}};
}

Vec2 by_opencv(bool is_fish, const cv::Mat& k, const cv::Mat& d, Vec3 rotation, Vec3 translation, Vec3 p) {
  const std::vector<cv::Point3d> points{{p.x, p.y, p.z}};
  std::vector<cv::Point2d> pixels;
  const cv::Vec3d r(rotation.x, rotation.y, rotation.z), t(translation.x, translation.y, translation.z);
  if (is_fish)
    cv::fisheye::projectPoints(points, pixels, r, t, k, d);
  else
    cv::projectPoints(points, r, t, k, d, pixels);
  return {pixels[0].x, pixels[0].y};
}

TEST(ExportOpencv, FileStorageReadsItAndProjectsTheSame) {
  for (const Lens& lens : lenses_of_opencv()) {
    SCOPED_TRACE(lens.model);
    manifest::Document document = document_with(lens.model, lens.terms);
    document.cameras["wide"].rms_px = 0.125;
    const auto files = export_cameras(document, {.format = "opencv"});
    const cv::FileStorage yaml(content_of(files, "wide.yaml"), cv::FileStorage::READ | cv::FileStorage::MEMORY);
    EXPECT_EQ(static_cast<int>(yaml["image_width"]), 640);
    EXPECT_EQ(static_cast<int>(yaml["image_height"]), 400);
    EXPECT_EQ(static_cast<double>(yaml["avg_reprojection_error"]), 0.125);
    const cv::Mat k = yaml["camera_matrix"].mat(), d = yaml["distortion_coefficients"].mat();
    const cv::Mat poses = yaml["extrinsic_parameters"].mat();
    ASSERT_EQ(poses.rows, 2);
    for (int i = 0; i < 2; ++i) {
      const auto row = poses.ptr<double>(i);
      const std::string name = static_cast<std::string>(yaml["image_names"][i]);
      expect_same_pixels(
          document, name,
          [&](Vec3 p) {
            return by_opencv(lens.model == "fisheye", k, d, {row[0], row[1], row[2]}, {row[3], row[4], row[5]}, p);
          },
          1e-6);
    }
  }
}

TEST(ExportRos, ProjectsTheSameByItsModelsName) {
  for (const Lens& lens : lenses_of_opencv()) {
    SCOPED_TRACE(lens.model);
    const manifest::Document document = document_with(lens.model, lens.terms);
    if (lens.model == "thin-prism") {
      EXPECT_THROW(export_cameras(document, {.format = "ros"}), Error);
      continue;
    }
    const std::string yaml = content_of(export_cameras(document, {.format = "ros"}), "wide.yaml");
    const auto k = numbers_after(yaml, "data", yaml.find("camera_matrix"));
    const auto d = numbers_after(yaml, "data", yaml.find("distortion_coefficients"));
    const auto r = numbers_after(yaml, "data", yaml.find("rectification_matrix"));
    const auto p = numbers_after(yaml, "data", yaml.find("projection_matrix"));
    const bool fish = yaml.find("distortion_model: equidistant\n") != std::string::npos;
    EXPECT_EQ(fish, lens.model == "fisheye");
    EXPECT_EQ(yaml.find("distortion_model: rational_polynomial\n") != std::string::npos, lens.model == "rational");
    EXPECT_EQ(d.size(), fish ? 4u : lens.model == "rational" ? 8u : 5u);
    ASSERT_EQ(k.size(), 9u);
    EXPECT_EQ(r, (std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
    EXPECT_EQ(p, (std::vector<double>{k[0], 0, k[2], 0, 0, k[4], k[5], 0, 0, 0, 1, 0}));
    const cv::Mat matrix = cv::Mat(k, true).reshape(1, 3), coefficients = cv::Mat(d, true);
    const auto camera_from_world = inverse(*document.images[0].world_from_camera);
    expect_same_pixels(
        document, "v0", [&](Vec3 q) { return by_opencv(fish, matrix, coefficients, {}, {}, camera_from_world * q); },
        1e-6);
  }
}

struct ColmapCamera {
  std::string model;
  std::vector<double> p;
};

// colmap/src/colmap/sensor/models.h, as its documentation describes them.
Vec2 by_colmap(const ColmapCamera& camera, double u, double v) {
  const auto& p = camera.p;
  const double r2 = u * u + v * v, uv = u * v;
  if (camera.model == "SIMPLE_PINHOLE") return {p[0] * u + p[1], p[0] * v + p[2]};
  if (camera.model == "OPENCV_FISHEYE") {
    const double r = std::sqrt(r2), theta = std::atan(r), t2 = theta * theta;
    const double radial = theta * (1 + t2 * (p[4] + t2 * (p[5] + t2 * (p[6] + t2 * p[7])))) / r;
    return {p[0] * u * radial + p[2], p[1] * v * radial + p[3]};
  }
  double du = 0, dv = 0;
  if (camera.model == "OPENCV") {
    const double radial = p[4] * r2 + p[5] * r2 * r2;
    du = u * radial + 2 * p[6] * uv + p[7] * (r2 + 2 * u * u);
    dv = v * radial + 2 * p[7] * uv + p[6] * (r2 + 2 * v * v);
  } else if (camera.model == "FULL_OPENCV") {
    const double r4 = r2 * r2, r6 = r4 * r2;
    const double radial = (1 + p[4] * r2 + p[5] * r4 + p[8] * r6) / (1 + p[9] * r2 + p[10] * r4 + p[11] * r6);
    du = u * radial + 2 * p[6] * uv + p[7] * (r2 + 2 * u * u) - u;
    dv = v * radial + 2 * p[7] * uv + p[6] * (r2 + 2 * v * v) - v;
  } else {
    EXPECT_EQ(camera.model, "PINHOLE");
  }
  return {p[0] * (u + du) + p[2], p[1] * (v + dv) + p[3]};
}

std::map<int, ColmapCamera> colmap_cameras(const std::string& text) {
  std::map<int, ColmapCamera> cameras;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    int id = 0, width = 0, height = 0;
    std::string model;
    words >> id >> model >> width >> height;
    for (double v = 0; words >> v;) cameras[id].p.push_back(v);
    cameras[id].model = model;
  }
  return cameras;
}

void expect_colmap_projects_the_same(const manifest::Document& document, const std::vector<ExportedFile>& files) {
  const auto cameras = colmap_cameras(content_of(files, "cameras.txt"));
  std::istringstream lines(content_of(files, "images.txt"));
  int images = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line[0] == '#') continue;
    std::istringstream words(line);
    int id = 0, camera = 0;
    Rigid<frame::Camera, frame::World> pose;
    std::string name, points;
    words >> id >> pose.rotation.w >> pose.rotation.x >> pose.rotation.y >> pose.rotation.z >> pose.translation_m.x >>
        pose.translation_m.y >> pose.translation_m.z >> camera >> name;
    EXPECT_EQ(id, ++images);
    std::getline(lines, points);
    EXPECT_EQ(points, "");
    expect_same_pixels(
        document, name,
        [&](Vec3 p) {
          const Vec3 c = pose * p;
          return by_colmap(cameras.at(camera), c.x / c.z, c.y / c.z) -
                 Vec2{0.5, 0.5};  // its pixel centres are at + 0.5
        },
        1e-6);
  }
  EXPECT_EQ(images, 3);
}

TEST(ExportColmap, ProjectsTheSameWithTheSimplestModelThatHoldsTheLens) {
  const Terms two = {{"k1", -0.281}, {"k2", 0.025}, {"p1", 0.0031}, {"p2", -0.0021}};
  const std::vector<std::pair<Lens, std::string>> cases = {{{"pinhole", {}}, "PINHOLE"},
                                                           {{"radial-tangential", two}, "OPENCV"},
                                                           {{"radial-tangential", brown}, "FULL_OPENCV"},
                                                           {{"rational", rational}, "FULL_OPENCV"},
                                                           {{"fisheye", fisheye}, "OPENCV_FISHEYE"}};
  for (const auto& [lens, model] : cases) {
    SCOPED_TRACE(model);
    const manifest::Document document = document_with(lens.model, lens.terms);
    const auto files = export_cameras(document, {.format = "colmap"});
    for (const auto& [id, camera] : colmap_cameras(content_of(files, "cameras.txt"))) EXPECT_EQ(camera.model, model);
    expect_colmap_projects_the_same(document, files);
  }
  const manifest::Document square = exported_document(true);
  const auto files = export_cameras(square, {.format = "colmap"});
  EXPECT_EQ(colmap_cameras(content_of(files, "cameras.txt")).at(1).model, "SIMPLE_PINHOLE");
  expect_colmap_projects_the_same(square, files);
}

TEST(ExportColmap, RefusesNamesThatItWouldCutOff) {
  manifest::Document document = exported_document(true);
  document.images[1].id = "first try";
  EXPECT_THROW(export_cameras(document, {.format = "colmap"}), Error);
}

TEST(ExportColmap, RefusesAThinPrism) {
  EXPECT_THROW(export_cameras(document_with("thin-prism", {{"s1", 0.01}}), {.format = "colmap"}), Error);
}

TEST(Export, LeavesOutTheCameraWhosePicturesAreAnothersNow) {
  manifest::Document document = document_with("radial-tangential", brown);
  document.cameras["straight"] = far_off_centre(true);
  for (auto& image : document.images) image.camera = "straight";
  EXPECT_EQ(export_cameras(document, {.format = "mitsuba"}).size(), 3u);
  document.images[0].camera = "wide";
  EXPECT_THROW(export_cameras(document, {.format = "mitsuba"}), Error);
  EXPECT_EQ(export_cameras(document, {.format = "mitsuba", .images = {"v1"}}).size(), 1u);
}

TEST(Export, PosesAgainstTheBoard) {
  manifest::Document document = exported_document(true);
  for (auto& image : document.images) {
    image.camera_from_board.emplace();
    const auto pose = inverse(*image.world_from_camera);
    image.camera_from_board->rotation = pose.rotation;
    image.camera_from_board->translation_m = pose.translation_m;
  }
  const auto world = export_cameras(document, {.format = "colmap"});
  for (auto& image : document.images) image.world_from_camera.reset();
  const auto board = export_cameras(document, {.format = "colmap", .board_frame = true});
  EXPECT_EQ(colmap_cameras(content_of(world, "cameras.txt")).size(), 2u);
  std::istringstream a(content_of(world, "images.txt")), b(content_of(board, "images.txt"));
  for (std::string u, v; a >> u;) {
    ASSERT_TRUE(b >> v);
    char* end = nullptr;
    const double x = std::strtod(u.c_str(), &end);
    if (*end == 0) {
      EXPECT_NEAR(x, std::strtod(v.c_str(), nullptr), 1e-12);
    }
  }
}

}  // namespace
}  // namespace gonio::camera
