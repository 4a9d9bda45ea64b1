// Errors of the shared reconstructions to the digits that were printed for them, each with its alignment; and what the
// measures are by definition.
#include "nrsfm/evaluate/errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "base/error.h"
#include "data.h"
#include "nrsfm/files.h"
#include "shapes.h"

namespace gonio::nrsfm {
namespace {

struct Case {
  const char* file;
  double none, global_rotation, frame_rotation, nrmse_rotation, nrmse_similarity;
};

// e3D of the authors' own reconstructions (Akhter et al. 2008): beside the file, computed with NumPy.
TEST(Errors, OfTheAuthorsReconstructionsOfMotionCapture) {
  GONIO_NEEDS_DATA("nrsfm/pta_mocap");
  for (const Case& c :
       {Case{"drink", 0.0249568583862, 0.0249447966376, 0.0225732816413, 0.0140800983283, 0.0137045353062},
        Case{"stretch", 0.108778009717, 0.108666768961, 0.081759012818, 0.0504641924424, 0.0496381008659},
        Case{"yoga", 0.162451782184, 0.148292822741, 0.0476442416601, 0.0318751107356, 0.0312526502434}}) {
    const auto path = gonio::tests::data("nrsfm/pta_mocap") / (std::string(c.file) + ".mat");
    const Sequence s = read_sequence(path);
    const Reconstruction r = read_reconstruction(path);
    EXPECT_NEAR(e3d(r.shapes, *s.truth, Alignment::none), c.none, 1e-9) << c.file;
    EXPECT_NEAR(e3d(r.shapes, *s.truth, Alignment::global_rotation), c.global_rotation, 1e-9) << c.file;
    EXPECT_NEAR(e3d(r.shapes, *s.truth, Alignment::frame_rotation), c.frame_rotation, 1e-9) << c.file;
    EXPECT_NEAR(nrmse(r.shapes, *s.truth, Alignment::frame_rotation), c.nrmse_rotation, 1e-9) << c.file;
    EXPECT_NEAR(nrmse(r.shapes, *s.truth, Alignment::frame_similarity), c.nrmse_similarity, 1e-9) << c.file;
  }
}

TEST(Errors, OfConsensusReconstructionsOfWalkingAndJaws) {
  GONIO_NEEDS_DATA("nrsfm/torresani");
  for (const Case& c :
       {Case{"walking", 0.0579740401069, 0.0581296942503, 0.0538842058629, 0.0344859193209, 0.0341389756698},
        Case{"jaws", 0.135886538775, 0.139137242104, 0.0871881150423, 0.0488259063971, 0.0410571661781}}) {
    const auto folder = gonio::tests::data("nrsfm/torresani");
    const Sequence s = read_sequence(folder / (std::string(c.file) + "_rearranged.mat"));
    const Reconstruction r = read_reconstruction(folder / ("peer_X_" + std::string(c.file) + ".mat"));
    EXPECT_NEAR(e3d(r.shapes, *s.truth, Alignment::none), c.none, 1e-9) << c.file;
    EXPECT_NEAR(e3d(r.shapes, *s.truth, Alignment::global_rotation), c.global_rotation, 1e-9) << c.file;
    EXPECT_NEAR(e3d(r.shapes, *s.truth, Alignment::frame_rotation), c.frame_rotation, 1e-9) << c.file;
    EXPECT_NEAR(nrmse(r.shapes, *s.truth, Alignment::frame_rotation), c.nrmse_rotation, 1e-9) << c.file;
    EXPECT_NEAR(nrmse(r.shapes, *s.truth, Alignment::frame_similarity), c.nrmse_similarity, 1e-9) << c.file;
  }
}

struct Perspective {
  const char *set, *method;
  double rmse_one_scale, mean_one_scale, rmse_similarity, mean_similarity;
};

// Depths of isometric methods: rms and mean after centring and a rotation per frame, with one scale or one per frame.
TEST(Errors, OfPerspectiveDepths) {
  GONIO_NEEDS_DATA("nrsfm/totem_perspective");
  const auto folder = gonio::tests::data("nrsfm/totem_perspective");
  for (const Perspective& c :
       {Perspective{"cushion", "MDH_SOCP", 24.989107835, 15.5184756955, 24.5199293651, 13.89458036},
        Perspective{"cushion", "MLH_SDP", 23.8072123481, 13.8781342124, 23.2921755717, 12.2153561538},
        Perspective{"kinectPaper", "MDH_SOCP", 6.54459509094, 5.49569965634, 6.49347507657, 5.44037607519},
        Perspective{"kinectPaper", "MLH_SDP", 6.64318463581, 5.67449203194, 6.6083414756, 5.63915013258},
        Perspective{"whiteCartoonTshirt", "MDH_SOCP", 0.654586276347, 0.479191183524, 0.109433204534, 0.0885539610441},
        Perspective{"whiteCartoonTshirt", "MLH_SDP", 0.654789071023, 0.480158255069, 0.117012689058,
                    0.0946898509778}}) {
    const Sequence s = read_sequence(folder / ("data_" + std::string(c.set) + ".mat"));
    FileNames names;
    names.shapes = c.method;
    const Reconstruction r = read_reconstruction(folder / (std::string(c.set) + "_Initialisation.mat"), names);
    EXPECT_EQ(s.truth_frame, ShapeFrame::camera);
    EXPECT_EQ(s.projection, Projection::perspective);
    EXPECT_EQ(r.frame, ShapeFrame::camera);
    const Aligned one = align(r.shapes, *s.truth, Alignment::frame_rotation_one_scale);
    const Aligned each = align(r.shapes, *s.truth, Alignment::frame_similarity);
    EXPECT_NEAR(rmse(one) / c.rmse_one_scale, 1, 1e-9) << c.set << c.method;
    EXPECT_NEAR(mean_distance(one) / c.mean_one_scale, 1, 1e-9) << c.set << c.method;
    EXPECT_NEAR(rmse(each) / c.rmse_similarity, 1, 1e-9) << c.set << c.method;
    EXPECT_NEAR(mean_distance(each) / c.mean_similarity, 1, 1e-9) << c.set << c.method;
  }
}

constexpr std::array all_alignments = {
    Alignment::none,           Alignment::global_rotation,  Alignment::global_similarity,
    Alignment::frame_rotation, Alignment::frame_similarity, Alignment::frame_rotation_one_scale};

TEST(Errors, OfTheTruthAreZero) {
  const Shapes q = tests::deforming(20, 30, 1);
  for (const Alignment a : all_alignments) {
    EXPECT_LT(e3d(q, q, a), 1e-12) << alignment_names()[static_cast<std::size_t>(a)];
    EXPECT_LT(nrmse(q, q, a), 1e-12);
    EXPECT_LT(rmse(q, q, a), 1e-12);
  }
}

// Each alignment takes away what its name says, and no more.
TEST(Errors, AlignmentsUndoWhatTheyName) {
  Random random(3);
  const Shapes q = tests::deforming(12, 25, 2);
  const Eigen::Matrix3d r = tests::any_rotation(random);
  const Shapes turned = tests::moved_all(q, 1, r, {3, -2, 1});
  EXPECT_GT(e3d(turned, q, Alignment::none), 0.1);
  EXPECT_LT(e3d(turned, q, Alignment::global_rotation), 1e-12);
  const Shapes larger = tests::moved_all(q, 2, r, {3, -2, 1});
  EXPECT_GT(e3d(larger, q, Alignment::frame_rotation), 0.1);
  EXPECT_LT(e3d(larger, q, Alignment::frame_rotation_one_scale), 1e-12);
  EXPECT_LT(e3d(larger, q, Alignment::global_similarity), 1e-12);
  const Shapes mirrored = tests::moved_all(q, 2, -r, {3, -2, 1});
  EXPECT_GT(e3d(mirrored, q, Alignment::frame_rotation_one_scale), 0.1);
  EXPECT_LT(e3d(mirrored, q, Alignment::frame_similarity), 1e-12);
  EXPECT_LT(e3d(mirrored, q, Alignment::global_similarity), 1e-12);
  EXPECT_THAT(align(mirrored, q, Alignment::frame_similarity).mirrored, testing::Each(1));
  Shapes each = q;
  for (Eigen::Index f = 0; f < 12; ++f)
    shape_of(each, f) = (tests::any_rotation(random) * shape_of(q, f)).colwise() + Eigen::Vector3d(f, 0, 1);
  EXPECT_GT(e3d(each, q, Alignment::global_rotation), 0.1);
  EXPECT_LT(e3d(each, q, Alignment::frame_rotation), 1e-12);
  EXPECT_GT(e3d(each, q, Alignment::global_similarity), 0.1);
}

// The more freely, the smaller: each least-squares alignment against those it contains.
TEST(Errors, FreerAlignmentsAreNoWorse) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Shapes q = tests::deforming(15, 20, seed), x = tests::noisy(q, 0.02, 0.1, seed);
    const auto rms = [&](Alignment a) { return rmse(x, q, a); };
    EXPECT_LE(rms(Alignment::global_rotation), rms(Alignment::none) * (1 + 1e-12));
    EXPECT_LE(rms(Alignment::frame_rotation), rms(Alignment::global_rotation) * (1 + 1e-12));
    EXPECT_LE(rms(Alignment::frame_rotation_one_scale), rms(Alignment::frame_rotation) * (1 + 1e-12));
    EXPECT_LE(rms(Alignment::frame_similarity), rms(Alignment::frame_rotation_one_scale) * (1 + 1e-12));
  }
}

TEST(Errors, PointsWithoutAnEstimateDoNotCount) {
  const Shapes q = tests::deforming(10, 30, 4);
  Shapes x = tests::moved_all(q, 3, Eigen::Matrix3d::Identity(), {1, 2, 3});
  for (Eigen::Index f = 0; f < 10; ++f)
    x.block<3, 1>(3 * f, 2 * f).setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_LT(rmse(x, q, Alignment::frame_similarity), 1e-12);
  EXPECT_LT(rmse(x, q, Alignment::global_similarity), 1e-12);
  const RobustError e = robust_error(x, q);
  EXPECT_LT(e.value, 1e-12);
  EXPECT_NEAR(e.estimated, 1 - 1 / 30.0, 1e-12);
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data);
    return error.what();
  }
  return "none";
}

TEST(Errors, RefuseWhatCannotBeCompared) {
  const Shapes q = tests::deforming(10, 8, 5);
  EXPECT_THAT(refusal([&] { e3d(q.topRows(27), q, Alignment::none); }),
              testing::HasSubstr("9 frames x 8 points, the truth has 10 frames x 8 points"));
  EXPECT_THAT(refusal([&] { align(q.topRows(28), q, Alignment::none); }), testing::HasSubstr("not a multiple of 3"));
  Shapes nothing = q;
  nothing.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(refusal([&] { robust_error(nothing, q); }), testing::HasSubstr("0 finite points"));
  EXPECT_THAT(refusal([&] { robust_error(Shapes::Zero(30, 8), q); }),
              testing::HasSubstr("all its points in one place"));
  EXPECT_THAT(refusal([&] { robust_error(q, Shapes::Ones(30, 8)); }),
              testing::HasSubstr("all its points in one place"));
  Shapes few = q;
  few.topRows(18).rightCols(6).setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(refusal([&] { e3d(few, q, Alignment::frame_rotation); }), testing::HasSubstr("6 of 10 frames"));
}

}  // namespace
}  // namespace gonio::nrsfm
