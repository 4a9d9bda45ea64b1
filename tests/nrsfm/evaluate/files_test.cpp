// Sequences and reconstructions as files: every data set as it lies there, our own back and forth, and what is refused.
#include "nrsfm/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "io/mat.h"
#include "io/ply.h"
#include "nrsfm/variables.h"
#include "shapes.h"

namespace gonio::nrsfm {
namespace {

using testing::Contains;
using testing::HasSubstr;

TEST(SequenceFiles, ReadEveryDataSet) {
  GONIO_NEEDS_DATA("nrsfm");
  struct Set {
    const char* path;
    Eigen::Index points, frames;
    Projection projection;
    ShapeFrame frame;
  };
  const auto ortho = Projection::orthographic;
  for (const Set& set :
       {Set{"pta_mocap/drink.mat", 41, 1102, ortho, ShapeFrame::object},
        Set{"pta_mocap/stretch.mat", 41, 370, ortho, ShapeFrame::object},
        Set{"pta_mocap/yoga.mat", 41, 307, ortho, ShapeFrame::object},
        Set{"torresani/jaws_rearranged.mat", 91, 240, ortho, ShapeFrame::camera},
        Set{"torresani/face_rearranged.mat", 40, 316, ortho, ShapeFrame::camera},
        Set{"torresani/walking_rearranged.mat", 55, 260, ortho, ShapeFrame::camera},
        Set{"totem_perspective/data_cushion.mat", 80, 4, Projection::perspective, ShapeFrame::camera},
        Set{"totem_perspective/data_kinectPaper.mat", 90, 10, Projection::perspective, ShapeFrame::camera},
        Set{"totem_perspective/data_whiteCartoonTshirt.mat", 85, 10, Projection::perspective, ShapeFrame::camera}}) {
    const Sequence s = read_sequence(gonio::tests::data("nrsfm") / set.path);
    EXPECT_EQ(s.points(), set.points) << set.path;
    EXPECT_EQ(s.frames(), set.frames) << set.path;
    EXPECT_EQ(s.projection, set.projection) << set.path;
    EXPECT_EQ(s.truth_frame, set.frame) << set.path;
    EXPECT_TRUE(s.complete()) << set.path;
    ASSERT_TRUE(s.truth) << set.path;
    EXPECT_EQ(s.truth->rows(), 3 * set.frames) << set.path;
    if (set.projection == Projection::perspective) continue;
    const Shapes seen = s.cameras.empty() ? *s.truth : in_cameras(*s.truth, s.cameras);  // tracks are the truth, seen
    for (Eigen::Index f = 0; f < s.frames(); f += 37)
      EXPECT_LT((shape_of(seen, f).topRows<2>() - s.tracks.middleRows<2>(2 * f)).norm(), 1e-9 * s.tracks.norm())
          << set.path;
  }
}

// Depths times rays: the true points' pixels are the tracks, and so are the reconstruction's.
TEST(SequenceFiles, PerspectiveDepthsLieOnTheirRays) {
  GONIO_NEEDS_DATA("nrsfm/totem_perspective");
  const auto folder = gonio::tests::data("nrsfm/totem_perspective");
  const Sequence s = read_sequence(folder / "data_kinectPaper.mat");
  std::vector<std::string> notes;
  const Reconstruction r = read_reconstruction(folder / "kinectPaper_Initialisation.mat", {}, &notes);
  EXPECT_THAT(notes, Contains(HasSubstr("MDH_SOCP")));
  const double f = 528.0144, cx = 320, cy = 240;
  for (Eigen::Index frame = 0; frame < s.frames(); ++frame)
    for (Eigen::Index p = 0; p < s.points(); ++p) {
      const Eigen::Vector3d x = shape_of(r.shapes, frame).col(p), q = shape_of(*s.truth, frame).col(p);
      const Eigen::Vector2d pixel(f * x.x() / x.z() + cx, f * x.y() / x.z() + cy),
          of_truth(f * q.x() / q.z() + cx, f * q.y() / q.z() + cy);
      EXPECT_LT((pixel - s.tracks.block<2, 1>(2 * frame, p)).norm(), 1e-8);
      EXPECT_LT((of_truth - s.tracks.block<2, 1>(2 * frame, p)).norm(), 2.2);
    }
}

Sequence example() {
  Sequence s;
  s.name = "bend-circle";
  s.truth = tests::deforming(5, 7, 1);
  s.projection = Projection::perspective;
  s.pinhole = Pinhole{500, 510, 320, 240};
  s.unit_m = 0.001;
  s.factors = {{"deformation", "bending"}, {"path", "circle"}};
  Random random(1);
  for (int f = 0; f < 5; ++f) s.cameras.push_back({tests::any_rotation(random), {0.1 * f, 0, 1}});
  s.tracks = Eigen::MatrixXd::Random(10, 7);
  s.visible = Visible::Constant(5, 7, true);
  s.visible(2, 3) = false;
  s.tracks.block<2, 1>(4, 3).setConstant(std::numeric_limits<double>::quiet_NaN());
  return s;
}

TEST(SequenceFiles, RoundTripToTheLastBit) {
  const gonio::tests::ScratchFolder folder;
  const Sequence s = example();
  write_sequence(s, folder / "s.mat");
  const Sequence back = read_sequence(folder / "s.mat");
  EXPECT_EQ(back.name, s.name);
  EXPECT_EQ(back.projection, s.projection);
  EXPECT_EQ(back.pinhole->fy_px, 510);
  EXPECT_EQ(back.unit_m, s.unit_m);
  EXPECT_EQ(back.factors, s.factors);
  EXPECT_EQ(*back.truth, *s.truth);
  EXPECT_EQ(back.truth_frame, ShapeFrame::object);
  EXPECT_TRUE((back.visible == s.visible).all());
  for (Eigen::Index i = 0; i < s.tracks.size(); ++i)
    EXPECT_TRUE(back.tracks.data()[i] == s.tracks.data()[i] || std::isnan(s.tracks.data()[i]));
  for (int f = 0; f < 5; ++f) {
    EXPECT_LT((back.cameras[f].rotation - s.cameras[f].rotation).norm(), 1e-14);
    EXPECT_EQ(back.cameras[f].translation, s.cameras[f].translation);
  }
  write_sequence(s, folder / "again.mat");
  EXPECT_EQ(read_file(folder / "s.mat"), read_file(folder / "again.mat"));  // no date inside
}

TEST(ReconstructionFiles, RoundTripToTheLastBit) {
  const gonio::tests::ScratchFolder folder;
  Reconstruction r;
  r.name = "pta";
  r.sequence = "bend";
  r.frame = ShapeFrame::camera;
  r.shapes = tests::deforming(4, 6, 3);
  r.shapes(2, 2) = std::numeric_limits<double>::quiet_NaN();
  r.factors = {{"rank", "4"}};
  Random random(1);
  for (int f = 0; f < 4; ++f) r.rotations.push_back(tests::any_rotation(random).topRows<2>());
  write_reconstruction(r, folder / "r.mat");
  const Reconstruction back = read_reconstruction(folder / "r.mat");
  EXPECT_EQ(back.name, "pta");
  EXPECT_EQ(back.sequence, "bend");
  EXPECT_EQ(back.frame, ShapeFrame::camera);
  EXPECT_EQ(back.factors, r.factors);
  EXPECT_TRUE(std::isnan(back.shapes(2, 2)));
  EXPECT_EQ(back.shapes.bottomRows(9), r.shapes.bottomRows(9));
  for (int f = 0; f < 4; ++f) EXPECT_EQ(back.rotations[f], r.rotations[f]);
}

// Names and layouts that others use.
TEST(SequenceFiles, OtherNamesAndLayouts) {
  const gonio::tests::ScratchFolder folder;
  const Shapes q = tests::deforming(6, 5, 2);
  io::MatVariable x;
  x.size = {3, 5, 6};
  for (Eigen::Index f = 0; f < 6; ++f)
    for (Eigen::Index p = 0; p < 5; ++p)
      for (int i = 0; i < 3; ++i) x.values.push_back(q(3 * f + i, p));
  Eigen::MatrixXd w(12, 5), d = Eigen::MatrixXd::Zero(6, 5);
  for (Eigen::Index f = 0; f < 6; ++f) w.middleRows<2>(2 * f) = shape_of(q, f).topRows<2>();
  d(1, 2) = 1;
  io::write_mat({{"X", x}}, folder / "x.mat");
  const Sequence of_x = read_sequence(folder / "x.mat");
  EXPECT_EQ(*of_x.truth, q);
  EXPECT_EQ(of_x.tracks, w);
  EXPECT_EQ(read_reconstruction(folder / "x.mat").shapes, q);
  io::write_mat({{"tracks", variable_of(w)}, {"D", variable_of(d)}, {"GT", variable_of(q)}}, folder / "d.mat");
  std::vector<std::string> notes;
  const Sequence of_d = read_sequence(folder / "d.mat", {}, &notes);
  EXPECT_FALSE(of_d.visible(1, 2));
  EXPECT_TRUE(of_d.visible(0, 0));
  EXPECT_NEAR(of_d.missing_share(), 1 / 30.0, 1e-15);
  EXPECT_THAT(notes, Contains(HasSubstr("1 where a point is missing")));
  io::write_mat({{"mine", variable_of(w)}, {"yours", variable_of(q)}}, folder / "n.mat");
  FileNames names;
  names.tracks = "mine", names.truth = "yours";
  EXPECT_EQ(*read_sequence(folder / "n.mat", names).truth, q);
}

TEST(ReconstructionFiles, PlyPerFrameInTheOrderOfTheirNumbers) {
  const gonio::tests::ScratchFolder folder;
  const Shapes q = tests::deforming(12, 6, 2);
  for (Eigen::Index f = 0; f < 12; ++f) {
    io::TriangleMesh mesh;
    for (Eigen::Index p = 0; p < 6; ++p) {
      const Eigen::Vector3d v = shape_of(q, f).col(p);
      mesh.positions_m.push_back({v.x(), v.y(), v.z()});
    }
    mesh.triangles.push_back({0, 1, 2});
    io::write_ply(folder / ("frame_" + std::to_string(f) + ".ply"), mesh);
  }
  EXPECT_EQ(read_reconstruction(folder.path()).shapes, q);
  EXPECT_EQ(read_reconstruction(folder / "frame_*.ply").shapes, q);
  EXPECT_EQ(read_reconstruction(folder / "frame_?.ply").frames(), 10);
}

std::string refusal(const std::function<void()>& call, Exit code = Exit::data) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    return error.what();
  }
  return "none";
}

TEST(SequenceFiles, RefuseInWords) {
  const gonio::tests::ScratchFolder folder;
  const Shapes q = tests::deforming(6, 5, 2);
  const auto refused = [&](const io::MatFile& file) {
    io::write_mat(file, folder / "bad.mat");
    return refusal([&] { read_sequence(folder / "bad.mat"); });
  };
  const Eigen::MatrixXd w = Eigen::MatrixXd::Random(12, 5);
  EXPECT_THAT(refused({{"a", variable_of(w)}}), HasSubstr("has neither tracks (W) nor shapes (S); it has a"));
  EXPECT_THAT(refused({{"W", variable_of(Eigen::MatrixXd::Random(11, 5))}}), HasSubstr("2 for each frame"));
  EXPECT_THAT(refused({{"W", variable_of(w)}, {"S", variable_of(Shapes(q.topRows(15)))}}), HasSubstr("15 x 5"));
  EXPECT_THAT(refused({{"W", variable_of(w)}, {"V", variable_of(Eigen::MatrixXd::Ones(5, 5))}}),
              HasSubstr("6 frames x 5 points"));
  EXPECT_THAT(refused({{"W", variable_of(w)}, {"V", variable_of(Eigen::MatrixXd::Constant(6, 5, 0.5))}}),
              HasSubstr("other values than 0 and 1"));
  Eigen::MatrixXd holes = w;
  holes(3, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refused({{"W", variable_of(holes)}, {"V", variable_of(Eigen::MatrixXd::Ones(6, 5))}}),
              HasSubstr("point 2 is visible in frame 1"));
  EXPECT_THAT(refused({{"W", variable_of(w)}, {"R", variable_of(w)}}), HasSubstr("2F x 3 or 3F x 3"));
  EXPECT_THAT(refused({{"W", variable_of(w)}, {"R", variable_of(Eigen::MatrixXd::Random(12, 3))}}),
              HasSubstr("not orthonormal"));
  EXPECT_THAT(refused({{"W", variable_of(w)}, {"projection", variable_of(std::string("fisheye"))}}),
              HasSubstr("fisheye"));
  EXPECT_THAT(refused({{"W", variable_of(std::string("text"))}}), HasSubstr("holds no numbers"));
  EXPECT_THAT(refused({{"W", variable_of(Eigen::MatrixXd::Random(2, 5))}}), HasSubstr("1 frames, 2 is the least"));
  EXPECT_THAT(refused({{"W", variable_of(Eigen::MatrixXd::Random(12, 3))}}), HasSubstr("3 points, 4 is the least"));
  write_file(folder / "s.txt", "1 2 3");
  EXPECT_THAT(refusal([&] { read_sequence(folder / "s.txt"); }), HasSubstr("neither .mat nor .npz"));
  EXPECT_THAT(refusal([&] { read_sequence(folder / "none.mat"); }, Exit::no_input), HasSubstr("none.mat"));
  EXPECT_THAT(refusal([&] { read_reconstruction(folder / "f_*.ply"); }, Exit::no_input),
              HasSubstr("names no .ply file"));
  EXPECT_THAT(refusal([&] { write_sequence(example(), folder / "s.npz"); }, Exit::usage), HasSubstr("call it .mat"));
}

// numpy.save of doubles in C order: magic, version 1.0, length of the head, head, values.
std::string npy(const std::vector<std::size_t>& size, const std::vector<double>& values) {
  std::string shape;
  for (const std::size_t n : size) shape += std::to_string(n) + ",";
  std::string head = "{'descr': '<f8', 'fortran_order': False, 'shape': (" + shape + "), }";
  head.append(63 - (10 + head.size()) % 64, ' ') += '\n';
  std::string bytes = "\x93NUMPY\x01";
  bytes += '\0';
  bytes += static_cast<char>(head.size() % 256), bytes += static_cast<char>(head.size() / 256);
  bytes += head;
  return bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
}

// The axis of three coordinates tells which axis frames are on: NumPy's habits are read like MATLAB's.
TEST(ReconstructionFiles, NumPysOrdersOfAxes) {
  const gonio::tests::ScratchFolder folder;
  const std::size_t frames = 6, points = 5;
  const auto value = [](std::size_t f, std::size_t r, std::size_t p) { return double(100 * f + 10 * r + p); };
  struct Order {
    const char* name;
    std::vector<std::size_t> size;
    std::function<double(std::size_t, std::size_t, std::size_t)> at;
  };
  for (const Order& o :
       {Order{"3 x P x F", {3, points, frames}, [&](auto r, auto p, auto f) { return value(f, r, p); }},
        Order{"F x 3 x P", {frames, 3, points}, [&](auto f, auto r, auto p) { return value(f, r, p); }},
        Order{"F x P x 3", {frames, points, 3}, [&](auto f, auto p, auto r) { return value(f, r, p); }}}) {
    std::vector<double> values;
    for (std::size_t a = 0; a < o.size[0]; ++a)
      for (std::size_t b = 0; b < o.size[1]; ++b)
        for (std::size_t c = 0; c < o.size[2]; ++c) values.push_back(o.at(a, b, c));
    write_file(folder / "shapes.npy", npy(o.size, values));
    const Shapes shapes = read_reconstruction(folder / "shapes.npy").shapes;
    ASSERT_EQ(shapes.rows(), 18) << o.name;
    ASSERT_EQ(shapes.cols(), 5) << o.name;
    for (Eigen::Index row = 0; row < 18; ++row)
      for (Eigen::Index p = 0; p < 5; ++p)
        EXPECT_EQ(shapes(row, p), double(100 * (row / 3) + 10 * (row % 3) + p)) << o.name;
  }
  write_file(folder / "flat.npy", npy({6, 5, 2}, std::vector<double>(60)));
  EXPECT_THAT(refusal([&] { read_reconstruction(folder / "flat.npy"); }), HasSubstr("6 x 5 x 2 without an axis of 3"));
}

}  // namespace
}  // namespace gonio::nrsfm
