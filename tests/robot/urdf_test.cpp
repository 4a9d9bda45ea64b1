// Arms from URDF: the UR5 as its maker's ROS description has it (config/ur5/default_kinematics.yaml, ur_macro.xacro)
// and the IRB 1600 as ROS-Industrial's, held against the arms known by name.
#include "robot/urdf.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "data.h"
#include "inverse_world.h"

namespace gonio::robot {
namespace {

using namespace inverse_world;

std::string joint_text(const std::string& name, const std::string& type, const std::string& parent,
                       const std::string& child, const std::string& xyz, const std::string& rpy,
                       const std::string& more = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/><origin xyz=\"" + xyz + "\" rpy=\"" + rpy + "\"/>" + more + "</joint>\n";
}

std::string link_text(const std::string& name, const std::string& more = "") {
  return "<link name=\"" + name + "\">" + more + "</link>\n";
}

std::string mesh_text(const std::string& file, const std::string& xyz) {
  return "<collision><origin xyz=\"" + xyz + "\"/><geometry><mesh filename=\"" + file + "\"/></geometry></collision>";
}

const std::string axis_z =
    "<axis xyz=\"0 0 1\"/><limit lower=\"-6.28\" upper=\"6.28\" velocity=\"3.14\" effort=\"1\"/>";

std::string ur5_text() {
  std::string t = "<?xml version=\"1.0\"?>\n<robot name=\"ur5\">\n";
  for (const char* link :
       {"world", "base_link", "base", "shoulder", "upper_arm", "wrist_1", "wrist_2", "wrist_3", "tool0"})
    t += link_text(link);
  t += link_text("base_link_inertia", mesh_text("package://ur_description/meshes/ur5/collision/base.stl", "0 0 0"));
  t += link_text("forearm", mesh_text("package://ur_description/meshes/ur5/collision/forearm.stl", "0 0 0.0165"));
  t += link_text("camera", "<collision><geometry><box size=\"0.1 0.05 0.04\"/></geometry></collision>");
  t += joint_text("stand", "fixed", "world", "base_link", "1 2 3", "0 0 0.5");
  t += joint_text("to_base", "fixed", "base_link", "base", "0 0 0", "0 0 3.141592653589793");
  t += joint_text("to_inertia", "fixed", "base_link", "base_link_inertia", "0 0 0", "0 0 3.141592653589793");
  t += joint_text("pan", "revolute", "base_link_inertia", "shoulder", "0 0 0.089159", "0 0 0", axis_z);
  t += joint_text("lift", "revolute", "shoulder", "upper_arm", "0 0 0", "1.570796327 0 0", axis_z);
  t += joint_text("elbow", "revolute", "upper_arm", "forearm", "-0.425 0 0", "0 0 0", axis_z);
  t += joint_text("w1", "revolute", "forearm", "wrist_1", "-0.39225 0 0.10915", "0 0 0", axis_z);
  t += joint_text("w2", "revolute", "wrist_1", "wrist_2", "0 -0.09465 -1.941303950897609e-11", "1.570796327 0 0",
                  axis_z);
  t += joint_text("w3", "continuous", "wrist_2", "wrist_3", "0 0.0823 -1.688001216681175e-11",
                  "1.570796326589793 3.141592653589793 3.141592653589793", axis_z);
  t += joint_text("end", "fixed", "wrist_3", "tool0", "0 0 0", "0 0 0");
  t += joint_text("hold", "fixed", "tool0", "camera", "0 0 0.1", "0 0 1");
  return t + "</robot>\n";
}

UrdfArm arm_of_text(const std::string& text, const std::string& base, const std::string& tip) {
  return arm_of_urdf(io::parse_urdf(text, "arm.urdf"), base, tip, "arm.urdf");
}

TEST(Urdf, Ur5IsTheKnownArm) {
  const UrdfArm arm = arm_of_text(ur5_text(), "base", "tool0");
  const Arm& known = known_arm("ur5", "test");
  ASSERT_EQ(arm.arm.links.size(), 6u);
  EXPECT_EQ(arm.arm.name, "ur5");
  EXPECT_THAT(arm.joints, testing::ElementsAre("pan", "lift", "elbow", "w1", "w2", "w3"));
  EXPECT_EQ(arm.limits[2].upper_rad, 6.28);
  EXPECT_EQ(arm.limits[2].speed_rad_per_s, 3.14);
  EXPECT_FALSE(std::isfinite(arm.limits[5].upper_rad));  // continuous
  Random random(61, 1);
  for (int i = 0; i < 20; ++i) {
    const Joints q = random_joints(random);
    const auto pose = arm.base_from_first * flange(arm.arm.links, q) * arm.last_from_flange;
    const Miss miss = miss_of(known.links, q, pose);
    EXPECT_LT(miss.position_m, 2e-9);
    EXPECT_LT(miss.rotation_rad, 2e-9);
  }
  // In "base" the rows are enough: axis 1 is its z, axis 6 the flange's.
  EXPECT_LT(norm(arm.base_from_first.translation_m), 1e-12);
  EXPECT_LT(norm(arm.last_from_flange.translation_m), 1e-9);
  EXPECT_EQ(InverseKinematics(arm.arm.links).family(), Family::three_parallel);
}

TEST(Urdf, FromTheWorldItStandsWhereItIsPut) {
  const UrdfArm arm = arm_of_text(ur5_text(), "", "camera");
  const Joints q{0.1, -1, 0.8, 0.3, 0.5, -0.2};
  const auto pose = arm.base_from_first * flange(arm.arm.links, q) * arm.last_from_flange;
  const auto turn = [](double z) { return quaternion_of_rotation_vector({0, 0, z}); };
  const Rigid<frame::Base, frame::Base> world_from_base{turn(0.5 + pi), {1, 2, 3}};
  const Rigid<frame::Tool, frame::Tool> tool_from_camera{turn(1), {0, 0, 0.1}};
  const auto expected = world_from_base * flange(known_arm("ur5", "test").links, q) * tool_from_camera;
  EXPECT_LT(norm(pose.translation_m - expected.translation_m), 2e-9);
  EXPECT_LT(norm(rotation_vector_of(conjugate(pose.rotation) * expected.rotation)), 2e-9);
}

TEST(Urdf, CollisionShapesMoveWithTheirRow) {
  const UrdfArm arm = arm_of_text(ur5_text(), "base", "tool0");
  ASSERT_EQ(arm.bodies.size(), 3u);
  const UrdfArm whole = arm_of_text(ur5_text(), "base_link", "tool0");
  ASSERT_EQ(whole.bodies.size(), 3u);
  EXPECT_EQ(whole.bodies[0].link, "base_link_inertia");
  EXPECT_EQ(whole.bodies[0].behind, 0u);
  const CollisionBody& forearm = whole.bodies[1];
  EXPECT_EQ(forearm.link, "forearm");
  EXPECT_EQ(forearm.behind, 3u);
  EXPECT_EQ(forearm.shape.mesh, "package://ur_description/meshes/ur5/collision/forearm.stl");
  const CollisionBody& camera = whole.bodies[2];
  EXPECT_EQ(camera.behind, 6u);
  EXPECT_EQ(camera.shape.form, io::UrdfForm::box);
  EXPECT_EQ(camera.shape.size_m, (Vec3{0.1, 0.05, 0.04}));
  // The forearm's frame in the URDF at joints q, by hand: pan, lift, elbow.
  const Joints q{0.4, -0.9, 1.3, 0, 0, 0};
  const auto turn = [](Vec3 v) { return quaternion_of_rotation_vector(v); };
  using Step = Rigid<frame::Base, frame::Base>;
  const Step forearm_by_hand = Step{turn({0, 0, pi}), {}} * Step{turn({0, 0, q[0]}), {0, 0, 0.089159}} *
                               Step{turn({1.570796327, 0, 0}), {}} * Step{turn({0, 0, q[1]}), {}} *
                               Step{turn({0, 0, q[2]}), {-0.425, 0, 0}};
  const std::vector<double> three(q.begin(), q.begin() + 3);
  const auto placed =
      whole.base_from_first * flange(std::span(whole.arm.links).first(3), three) * forearm.frame_from_body;
  for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{0.1, 0.2, 0.3}})
    EXPECT_LT(norm(placed * p - forearm_by_hand * (p + Vec3{0, 0, 0.0165})), 1e-9);
}

TEST(Urdf, Irb1600IsTheKnownArm) {
  std::string t = "<robot name=\"irb1600\">";
  for (const char* link : {"base_link", "l1", "l2", "l3", "l4", "l5", "l6", "tool0"}) t += link_text(link);
  const char* children[] = {"base_link", "l1", "l2", "l3", "l4", "l5", "l6"};
  const char* origins[] = {"0 0 0", "0.15 0 0.4865", "0 0 0.700", "0.300 0 0", "0.300 0 0", "0.065 0 0"};
  const char* axes[] = {"0 0 1", "0 1 0", "0 1 0", "1 0 0", "0 1 0", "1 0 0"};
  for (int i = 0; i < 6; ++i)
    t += joint_text("j" + std::to_string(i + 1), "revolute", children[i], children[i + 1], origins[i], "0 0 0",
                    std::string("<axis xyz=\"") + axes[i] + "\"/><limit lower=\"-3\" upper=\"3\" velocity=\"2\"/>");
  t += joint_text("end", "fixed", "l6", "tool0", "0 0 0", "0 1.5707963267948966 0") + "</robot>";
  const UrdfArm arm = arm_of_text(t, "", "");
  const InverseKinematics inverse(arm.arm.links);
  EXPECT_EQ(inverse.family(), Family::spherical_wrist);
  EXPECT_TRUE(inverse.has_branches());
  Random random(67, 1);
  for (int i = 0; i < 20; ++i) {
    const Joints q = random_joints(random);
    const auto pose = arm.base_from_first * flange(arm.arm.links, q) * arm.last_from_flange;
    const Miss miss = miss_of(known_arm("abb-irb-1600", "test").links, q, pose);
    EXPECT_LT(miss.position_m, 1e-12);
    EXPECT_LT(miss.rotation_rad, 1e-12);
  }
}

void expect_refused(const std::string& text, const std::string& base, const std::string& tip,
                    const std::string& words) {
  try {
    arm_of_text(text, base, tip);
    FAIL() << "accepted, expected " << words;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    EXPECT_THAT(e.what(), testing::HasSubstr(words));
  }
}

TEST(Urdf, FaultsAreNamed) {
  const std::string good = ur5_text();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  expect_refused(good, "", "", "arm.urdf: ends in 2 links; name the flange's: base, camera");
  expect_refused(good, "bace", "tool0", "has no link \"bace\"; links are base,");
  expect_refused(good, "forearm", "shoulder", "link \"shoulder\" does not hang on \"forearm\"");
  expect_refused(good, "tool0", "camera", "no joint turns between \"tool0\" and \"camera\"");
  expect_refused(with("name=\"lift\" type=\"revolute\"", "name=\"lift\" type=\"prismatic\""), "base", "tool0",
                 "joint \"lift\" is prismatic");
  expect_refused(with("-0.425 0 0", "-0.425 0"), "base", "tool0", "xyz has 2 numbers where 3 are expected");
  expect_refused(with("-0.425 0 0", "-0.425 O 0"), "base", "tool0", "\"O\" in xyz is no finite number");
  expect_refused(with("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 0\"/>"), "base", "tool0", "axis without direction");
  expect_refused(with("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 1\"/><mimic joint=\"w1\"/>"), "base", "tool0",
                 "mimics another");
  expect_refused(with("lower=\"-6.28\"", "lower=\"7\""), "base", "tool0", "lower limit above its upper");
  expect_refused(with("<child link=\"upper_arm\"/>", "<child link=\"shoulder\"/>"), "base", "tool0",
                 "hangs on two joints");
  expect_refused(with("<child link=\"upper_arm\"/>", "<child link=\"lost\"/>"), "base", "tool0", "which is not there");
  expect_refused(with("<link name=\"shoulder\"></link>", "<xacro:arm name=\"x\"/>"), "base", "tool0",
                 "arm.urdf:6: <xacro:arm> is a macro of xacro; expand it: xacro in.xacro > out.urdf");
  expect_refused(with("-0.425 0 0", "${a2} 0 0"), "base", "tool0", "is a macro of xacro");
  expect_refused(with("</robot>", ""), "base", "tool0", "is no XML");
  expect_refused("<sdf/>", "", "", "has no <robot>");
}

TEST(Urdf, MeshesAreFound) {
  GONIO_NEEDS_DATA("robots/abb_irb1600");
  const auto description = tests::data("robots/abb_irb1600") / "urdf" / "irb1600_8_145.urdf";
  const auto found = mesh_of_urdf("package://abb_irb1600_support/meshes/irb1600/collision/link_1.stl", description);
  EXPECT_EQ(found.filename(), "link_1.stl");
  EXPECT_TRUE(std::filesystem::exists(found));
  EXPECT_TRUE(std::filesystem::exists(mesh_of_urdf("../meshes/irb1600/collision/link_3.stl", description)));
  try {
    mesh_of_urdf("package://abb_irb1600_support/meshes/none.stl", description);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::no_input);
    EXPECT_THAT(e.what(), testing::HasSubstr("put the folder \"abb_irb1600_support\" beside the description"));
  }
}

TEST(Urdf, TheMakersMacrosAreRefusedWithTheRemedy) {
  GONIO_NEEDS_DATA("robots/abb_irb1600");
  try {
    io::read_urdf(tests::data("robots/abb_irb1600/urdf/irb1600_8_145_macro.xacro"));
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("xacro in.xacro > out.urdf"));
  }
}

}  // namespace
}  // namespace gonio::robot
